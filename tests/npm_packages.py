"""Packages of npm that tests ask, at the versions of tests/web/package-lock.json, in the build folder. Standard library only."""
import pathlib
import shutil
import subprocess

WEB = pathlib.Path(__file__).resolve().parent / "web"


def npm(folder, *arguments):
    """What npm said where it failed, or None."""
    options = ("--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error")
    try:
        done = subprocess.run(["npm", *arguments, *options], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    return None if done.returncode == 0 else (done.stderr.strip() or done.stdout.strip() or "npm failed").splitlines()[0]


def installed(build):
    """The folder node_modules with the packages of the lock file, or None, and why there is none."""
    if not shutil.which("node") or not shutil.which("npm"):
        return None, "node and npm are absent (scripts/install-packages.sh installs them)"
    folder = build / "tests_web"
    folder.mkdir(parents=True, exist_ok=True)
    lock, done = (WEB / "package-lock.json").read_bytes(), folder / "installed"
    if not done.exists() or done.read_bytes() != lock:
        done.unlink(missing_ok=True)
        for name in ("package.json", "package-lock.json"):
            shutil.copy(WEB / name, folder / name)
        failed = npm(folder, "ci")
        if failed:
            return None, f"`npm ci` failed: {failed}"
        done.write_bytes(lock)
    return folder / "node_modules", None
