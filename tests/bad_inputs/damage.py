"""Ways to damage an input, for the rows of the table. Each names the file it is about, as the row's command does."""
import json
import os
import re
import shutil
import zlib

GONE = object()  # a JSON field that is taken away


class Damage:
    """What is wrong with an input: words for a person, and a function of the row's folder that makes it so."""

    def __init__(self, words, path, apply, source="", unprivileged=False):
        self.words, self.path, self.apply = words, path, apply
        self.source = source  # a further fixture that it takes
        self.unprivileged = unprivileged

    def __str__(self):
        return f"{self.path} {self.words}"


def _of_file(words, path, change):
    """Of a file that is there: change(bytes) -> bytes."""

    def apply(folder):
        file = folder / path
        before = file.read_bytes()
        after = change(before)
        if after == before:
            raise AssertionError(f"{path}: {words} changes nothing")
        file.write_bytes(after)

    return Damage(words, path, apply)


def _in_place_of(words, path, make):
    """make(path) once what stood there has gone."""

    def apply(folder):
        file = folder / path
        if file.is_dir() and not file.is_symlink():
            shutil.rmtree(file)
        else:
            file.unlink(missing_ok=True)
        file.parent.mkdir(parents=True, exist_ok=True)
        make(file)

    return Damage(words, path, apply)


def cut(path, size):
    """To a share of its length (0.5), to so many bytes (12), or by so many (-1)."""
    return _of_file(f"cut to {size}", path, lambda b: b[: int(size * len(b)) if isinstance(size, float) else size])


def patch(path, at, data):
    """Other bytes from `at` on, from the end if it is below 0."""

    def change(before):
        first = at % len(before)
        return before[:first] + data + before[first + len(data) :]

    return _of_file(f"with {data!r} at {at}", path, change)


def replace(path, pattern, text):
    """The first match of a regular expression over the file's bytes."""
    words = f"with {text[:60]!r} for {pattern!r}"
    return _of_file(words, path, lambda b: re.sub(pattern.encode("latin-1"), text.encode("latin-1"), b, count=1))


def append(path, data):
    return _of_file(f"with {data[:60]!r} behind it", path, lambda b: b + (data.encode() if isinstance(data, str) else data))


def write(path, data):
    """A file of these bytes, or this text, in its place."""
    data = data.encode("utf-8", "surrogateescape") if isinstance(data, str) else data
    words = f"= {data[:60]!r}" + (f" and {len(data) - 60} bytes, checksum {zlib.crc32(data):08x}" if len(data) > 60 else "")
    return _in_place_of(words, path, lambda file: file.write_bytes(data))


def remove(path):
    return _in_place_of("gone", path, lambda file: None)


def folder(path):
    return _in_place_of("a folder", path, lambda file: file.mkdir())


def fifo(path):
    return _in_place_of("a FIFO", path, os.mkfifo)


def loop(path):
    return _in_place_of("a link to itself", path, lambda file: file.symlink_to(file.name))


def link(path, target):
    return _in_place_of(f"a link to {target}", path, lambda file: file.symlink_to(target))


def copied(source, path):
    """A further copy of a fixture, or of a file of one."""

    def apply(folder):
        (shutil.copytree if (folder / source).is_dir() else shutil.copy)(folder / source, folder / path)

    return Damage(f"copied from {source}", path, apply, source=source)


def renamed(path, to):
    return Damage(f"renamed to {to}", path, lambda folder: (folder / path).rename(folder / to))


def unreadable(path):
    """To everybody but the superuser, as whom no row with this runs."""
    return Damage("unreadable", path, lambda folder: (folder / path).chmod(0), unprivileged=True)


def _edited(text, place, value):
    """The JSON object with a field, such as views[0].camera.fx, changed; GONE takes it away."""
    whole = at = json.loads(text)
    steps = [int(step) if step.isdigit() else step for step in re.findall(r"\w+", place)]
    for step in steps[:-1]:
        at = at[step]
    if value is GONE:
        del at[steps[-1]]
    else:
        at[steps[-1]] = value
    return whole


def _shown(place, value):
    return f"{place}: {'gone' if value is GONE else json.dumps(value)[:60]}"


def field(path, place, value):
    """A field of a JSON file."""
    return _of_file(_shown(place, value), path, lambda before: json.dumps(_edited(before, place, value)).encode())


def signed_field(path, place, value):
    """The same in a description of records, whose checksum is made to fit again (docs/formats.md, records.json)."""

    def change(before):
        whole = _edited(before, place, value)
        whole.pop("checksum", None)
        data = json.dumps(whole, separators=(",", ":")).encode()
        hash = 0xCBF29CE484222325
        for i in range(0, len(data), 8):
            hash = (hash ^ int.from_bytes(data[i : i + 8], "little")) * 0x100000001B3 % 2**64
            hash ^= hash >> 32
        return json.dumps({**whole, "checksum": hash}).encode()

    return _of_file(_shown(place, value) + ", checksum fitting", path, change)


def every_view(path, place, value):
    """The same field of all views of a dataset.json."""

    def apply(folder):
        for i in range(len(json.loads((folder / path).read_bytes())["views"])):
            field(path, f"views[{i}].{place}", value).apply(folder)

    return Damage(_shown(f"views[*].{place}", value), path, apply)

