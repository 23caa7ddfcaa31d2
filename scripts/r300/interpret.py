"""Runs one fragment through the SPIR-V of a stage, in double precision: so that a stage and its rewritten text can be compared on
inputs drawn at random. Textures have no end: what is at a place is drawn by a hash of it."""
import hashlib
import math
import re
import struct

SIDE = 64  # of every texture, by which look-ups between 0 and 1 are scaled


def drawn(*what):
    """A number in [0, 1) that what it is drawn for decides."""
    return int.from_bytes(hashlib.blake2b(repr(what).encode(), digest_size=6).digest(), "big") / 2.0**48


def bits_of(number):
    return struct.unpack("<I", struct.pack("<f", number))[0]


def float_of(bits):
    return struct.unpack("<f", struct.pack("<I", int(bits) & 0xFFFFFFFF))[0]


class Scene:
    """What one trial gives a stage. place: the fragment's."""

    def __init__(self, trial, stage, place, layout_width):
        self.trial, self.stage, self.place, self.layout_width = trial, stage, place, layout_width

    def uniform(self, name, index):
        if shift := re.search(r"_half_(m?\d+)_(m?\d+)$", name):
            return [(int(number.replace("m", "-")) + 0.5) / SIDE for number in shift.groups()] * 2
        if name.endswith(("_scale", "_half", "_rows", "_texels")):
            value = {"scale": 1 / SIDE, "half": 0.5 / SIDE, "rows": SIDE, "texels": 40}[name.rsplit("_", 1)[1]]
            return [value] * 4
        if name == "image_size":
            return [40.0] * 4
        if name == "one":
            return [1.0] * 4
        if name == "exposure":  # no channel reaches what is clipped
            return [drawn(self.trial, name), 0.5, 0.5, 1.0e6]
        values = [drawn(self.trial, name, index, i) * 2 - 0.5 for i in range(4)]
        return [0.0 if value < -0.25 else value for value in values]

    def varying(self, name):
        x, y = self.place
        if name in ("gl_FragCoord", "place"):
            return [x + 0.5, y + 0.5, 0.0, 1.0]
        if name == "own":
            return [(x + 0.5) / SIDE, (y + 0.5) / SIDE, 0.0, 0.0]
        if name.endswith("_scaled"):
            return [(value + 0.5) / SIDE for value in self.varying(name[:-7])]
        values = [drawn(self.trial, name, i) for i in range(4)]
        if name == "frame":
            turned = values[0] < 0.5
            corner = [int(values[1] * 8), int(values[2] * 8)]
            return [x + corner[0], y + corner[1], -1, 0] if turned else [max(0, x - corner[0]), max(0, y - corner[1]), 1, 0]
        if name == "problem":
            return [int(value * 30) for value in values]
        if name == "barycentric":
            return [values[0], values[1] * (1 - values[0]), 0, 0]
        return [value * 40 for value in values[:2]] + [1 + values[2], 0] if name.startswith("corner") else values

    def texel(self, name, index, layer, x, y, whole):
        """whole: the stage has integers and looks at bits; else numbers stand for both."""
        values = [drawn(self.trial, name, index, layer, x, y, i) for i in range(4)]
        if name == "items":
            here = self.place[1] * self.layout_width + self.place[0]
            return [here if values[0] < 0.7 else int(values[1] * 1000)] * 4
        if name == "image":
            return [int(value * 255) for value in values[:3]] + [255 if values[3] < 0.8 else 0]
        if name == "drawn":
            return [int(values[0] * 60) if values[1] < 0.8 else 0] * 4
        if name == "ring_table":
            none = 0xFFFFFFFF if whole else 2.0**32  # as a float holds it
            return [none if value < 0.2 else int(value * 40) | int(value * 997 % 40) << 14 | int(value * 9973 % 3) << 28
                    for value in values]
        if name == "source" and "FURTHER" in self.stage:
            sums = [bits_of(value) for value in values[2:]]
            return [int(values[0] * 9), int(values[1] * 9)] + (sums if whole else [float_of(bits) for bits in sums])
        if name == "footprints" and layer == 1:
            return [int(value * 7) for value in values]
        if name == "kept":
            return values[:3] + [1.0 if values[3] < 0.7 else 0.0]
        if name in ("state", "source"):
            if layer == 1:
                return [values[0] * 2 - 1 if values[3] < 0.7 else 0.0, float(values[1] < 0.6), float(values[2] < 0.3), int(values[3] * 9)]
            if layer == 0 and values[3] < 0.2:
                return [float_of(bits_of(3.0e38)), *values[1:]]  # HUGE_ERROR
        return [0.0 if value < 0.05 else float_of(bits_of(value * 2 - 0.7)) for value in values]


def each(work, *operands):
    """Component by component."""
    if any(isinstance(operand, list) for operand in operands):
        count = next(len(operand) for operand in operands if isinstance(operand, list))
        return [work(*(operand[i] if isinstance(operand, list) else operand for operand in operands)) for i in range(count)]
    return work(*operands)


def guarded(work):
    def safe(*numbers):
        try:
            return work(*numbers)
        except (ValueError, ZeroDivisionError, OverflowError):
            return math.nan
    return safe


def divided(a, b):
    return a / b if b else math.nan if not a or a != a else math.copysign(math.inf, a)


def least(a, b):
    return a if b != b or a < b else b


def most(a, b):
    return a if b != b or a > b else b


ARITHMETIC = {
    "Add": lambda a, b: a + b, "Sub": lambda a, b: a - b, "Mul": lambda a, b: a * b, "FDiv": divided,
    "SDiv": lambda a, b: int(math.trunc(a / b)), "UDiv": lambda a, b: a // b, "SMod": lambda a, b: a % b, "UMod": lambda a, b: a % b,
    "ShiftRightLogical": lambda a, b: (a & 0xFFFFFFFF) >> b, "ShiftRightArithmetic": lambda a, b: a >> b,
    "BitwiseAnd": lambda a, b: a & b,
    "Equal": lambda a, b: a == b, "NotEqual": lambda a, b: a != b, "LessThan": lambda a, b: a < b, "GreaterThan": lambda a, b: a > b,
    "LessThanEqual": lambda a, b: a <= b, "GreaterThanEqual": lambda a, b: a >= b, "LogicalAnd": lambda a, b: a and b,
    "LogicalOr": lambda a, b: a or b, "LogicalEqual": lambda a, b: a == b, "LogicalNotEqual": lambda a, b: a != b,
    "LogicalNot": lambda a: not a, "SNegate": lambda a: -a, "FNegate": lambda a: -a,
    "Select": lambda c, a, b: a if c else b,
    "ConvertSToF": float, "ConvertUToF": float, "FConvert": float, "UConvert": int, "SConvert": int,
    "ConvertFToS": lambda a: int(a) if math.isfinite(a) else 0, "ConvertFToU": lambda a: int(a) if math.isfinite(a) else 0,
}  # fmt: skip
FUNCTIONS = {
    "Min": least, "Max": most, "Clamp": lambda a, b, c: least(most(a, b), c), "Abs": abs,
    "Floor": lambda a: float(math.floor(a)) if math.isfinite(a) else a, "Sqrt": math.sqrt,
    "InverseSqrt": lambda a: 1 / math.sqrt(a), "Exp": math.exp, "Log": math.log, "Cos": math.cos, "Acos": math.acos,
    "Fma": lambda a, b, c: a * b + c, "FMix": lambda a, b, c: a + (b - a) * c,
}  # fmt: skip


class Program:
    """A stage's disassembly, to be run."""

    def __init__(self, disassembly, whole, rounds=False):
        self.whole = whole  # of integers, with bits; else the rewritten text
        self.rounds = rounds  # sums and products to floats
        self.constants, self.kinds, self.lengths, self.blocks, self.first = {}, {}, {}, {}, None
        self.variables, self.pointed, self.types = {}, {}, {}
        block = None
        for line in disassembly.splitlines():
            match = re.match(r"\s*(?:(%\w+) = )?Op(\w+)\s*(.*)$", line)
            if not match:
                continue
            result, op, rest = match[1], match[2], match[3].split()
            if op == "Label":
                block = result
                self.first = self.first or block
                self.blocks[block] = []
            elif block:
                self.blocks[block].append((result, op, rest))
            elif op in ("TypeInt", "TypeFloat", "TypeBool"):
                self.kinds[result], self.lengths[result] = "Double" if rest == ["64"] else op[4:], 1
            elif op == "TypeVector":
                self.kinds[result], self.lengths[result] = self.kinds[rest[0]], int(rest[1])
            elif op == "TypePointer":
                self.pointed[result] = rest[1]
            elif op == "Variable":
                self.variables[result] = rest[1]
                self.types[result] = self.pointed[rest[0]]
            elif op == "Constant":
                number = float.fromhex(rest[1]) if "0x" in rest[1] else float(rest[1])
                exact = {"Int": int, "Float": lambda x: float_of(bits_of(x)), "Double": float}  # printed with few digits
                self.constants[result] = exact[self.kinds[rest[0]]](number)
            elif op in ("ConstantTrue", "ConstantFalse"):
                self.constants[result] = op == "ConstantTrue"
            elif op == "ConstantComposite":
                self.constants[result] = [self.constants[part] for part in rest[1:]]
            elif op in ("Undef", "ConstantNull") and self.lengths.get(rest[0]):
                self.constants[result] = [0.0] * self.lengths[rest[0]] if self.lengths[rest[0]] > 1 else 0.0

    def shaped(self, type_name, values):
        count = self.lengths[type_name]
        return values[0] if count == 1 else values[:count]

    def run(self, scene):
        """What it writes, four numbers."""
        self.scene, self.values, self.places, self.written = scene, dict(self.constants), {}, None
        for variable in self.variables:
            self.places[variable] = (variable.lstrip("%"), ())
        before, block = None, self.first
        while block:
            at, block = block, None
            phis = [(result, rest) for result, op, rest in self.blocks[at] if op == "Phi"]
            chosen = [dict(zip(rest[2::2], rest[1::2]))[before] for _, rest in phis]
            for (result, _), value in zip(phis, [self.values[name] for name in chosen]):
                self.values[result] = value
            for result, op, rest in self.blocks[at]:
                if op in ("Branch", "BranchConditional"):
                    block = rest[0] if op == "Branch" else rest[1] if self.values[rest[0]] else rest[2]
                elif op not in ("Phi", "SelectionMerge", "Return", "FunctionEnd"):
                    self.step(result, op, rest)
            before = at
        return self.written

    def step(self, result, op, rest):
        v = self.values
        if op == "Undef":
            v[result] = [0.0] * self.lengths[rest[0]] if self.lengths[rest[0]] > 1 else 0.0
        elif op == "AccessChain":
            name, indices = self.places[rest[1]]
            self.places[result] = (name, indices + tuple(v[index] for index in rest[2:]))
        elif op == "Image":
            self.places[result] = self.places[rest[1]]
        elif op == "Load":
            self.load(result, rest)
        elif op == "Store":
            values = v[rest[1]] if isinstance(v[rest[1]], list) else [v[rest[1]]]
            self.written = values + [0] * (4 - len(values))
        elif op == "ImageQuerySizeLod":
            v[result] = self.shaped(rest[0], [40] * 4)
        elif op == "ImageFetch":
            name, index = self.places[rest[1]]
            x, y, *layer = v[rest[2]]
            v[result] = self.scene.texel(name, index, layer[0] if layer else 0, x, y, True)
        elif op in ("ImageSampleImplicitLod", "ImageSampleExplicitLod"):
            v[result] = self.sampled(self.places[rest[1]][0], *v[rest[2]])
        elif op == "CompositeConstruct":
            v[result] = sum(([*v[part]] if isinstance(v[part], list) else [v[part]] for part in rest[1:]), [])
        elif op == "CompositeExtract":
            v[result] = v[rest[1]][int(rest[2])]
        elif op == "CompositeInsert":
            v[result] = list(v[rest[2]])
            v[result][int(rest[3])] = v[rest[1]]
        elif op == "VectorShuffle":
            both = v[rest[1]] + v[rest[2]]
            v[result] = [both[int(number)] for number in rest[3:]]
        elif op == "VectorExtractDynamic":
            v[result] = v[rest[1]][v[rest[2]]]
        elif op == "VectorTimesScalar":
            v[result] = [a * v[rest[2]] for a in v[rest[1]]]
        elif op == "Dot":
            v[result] = sum(a * b for a, b in zip(v[rest[1]], v[rest[2]]))
        elif op in ("All", "Any"):
            v[result] = (all if op == "All" else any)(v[rest[1]])
        elif op == "Bitcast":
            v[result] = self.cast(rest[0], v[rest[1]])
        elif op == "ExtInst":
            v[result] = self.function(rest[2], [v[name] for name in rest[3:]])
        else:
            name = op if op in ARITHMETIC else re.sub("^(FOrd|FUnord|[FSUI])(?=[A-Z])", "", op)
            v[result] = each(guarded(ARITHMETIC[name]), *(v[operand] for operand in rest[1:]))
        if self.rounds and (op in ("FAdd", "FSub", "FMul") or op == "ExtInst" and rest[2] == "Fma"):
            v[result] = each(lambda number: float_of(bits_of(number)), v[result])

    def load(self, result, rest):
        name, indices = self.places[rest[1]]
        if rest[0] not in self.lengths:
            self.places[result] = (name, indices)
            return
        storage = self.variables["%" + name]
        if storage == "Output":
            self.values[result] = self.shaped(rest[0], self.written)
            return
        declared = self.types["%" + name]
        if storage == "Input":
            values = self.scene.varying(name)
            values = [values[indices[0]]] if indices else values
        else:
            values, component = self.uniform(name, indices, declared in self.lengths)
            values = values if component is None else [values[component]]
        self.values[result] = self.shaped(rest[0], values)

    def uniform(self, name, indices, is_vector):
        """The four numbers of a uniform, or of an array's element, and which of them is wanted."""
        element = None
        if not self.whole and "_half" not in name and re.search(r"_\d+$", name):
            name, _, element = name.rpartition("_")
            element = int(element)
        elif indices and not is_vector:
            element, indices = indices[0], indices[1:]
        return self.scene.uniform(name, element), indices[0] if indices else None

    def sampled(self, sampler, u, v):
        x, y = math.floor(u * SIDE), math.floor(v * SIDE)
        numbers = re.findall(r"_(\d+)", re.search(r"((?:_\d+)*)$", sampler)[1])
        name = re.sub(r"(?:_\d+)*$", "", sampler)
        if name == "vectors":
            return self.scene.texel(name, (int(numbers[0]),), int(numbers[1]), x, y, False)
        if numbers:
            return self.scene.texel(name, (), int(numbers[0]), x, y, False)
        return self.scene.texel(name, (), y // SIDE if name == "source" and y >= SIDE else 0, x, y % SIDE if y >= SIDE else y, False)

    def cast(self, type_name, value):
        if not self.whole:
            return value
        to_float = self.kinds[type_name] == "Float"
        is_float = isinstance(value[0] if isinstance(value, list) else value, float)
        if to_float == is_float:
            return value
        return each(float_of if to_float else bits_of, value)

    @staticmethod
    def function(name, operands):
        if name == "Normalize":
            length = math.sqrt(sum(a * a for a in operands[0]))
            return [divided(a, length) for a in operands[0]]
        if name == "Cross":
            a, b = operands
            return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        known = FUNCTIONS.get(name) or FUNCTIONS[re.sub("^[FSU]", "", name)]
        return each(guarded(known), *operands)


def same(a, b, tolerance):
    """Of what two programs write. What is no number in both is the same, too."""
    return all(x != x and y != y or x == y or abs(x - y) <= tolerance * max(1.0, abs(x), abs(y)) for x, y in zip(a, b))


def tells(written):
    """Whether what a program writes tells it from others: numbers, of which not all are 0."""
    return all(map(math.isfinite, written)) and any(written)
