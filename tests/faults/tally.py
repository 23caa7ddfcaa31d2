"""What a kind of fault came to."""
from dataclasses import dataclass, field


@dataclass
class Tally:
    name: str
    runs: int = 0
    hits: int = 0  # runs that the fault met before they had ended
    violations: list = field(default_factory=list)

    def add(self, hit, violations, how):
        self.runs += 1
        self.hits += bool(hit)
        self.violations += [f"{how}: {violation}" for violation in violations]

    def line(self):
        return f"{self.name}: {self.runs} runs, {self.hits} hit, {len(self.violations)} violations"
