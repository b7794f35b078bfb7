"""The rooms of the library, read from the calls of sansmesh_room() in sansmesh/CMakeLists.txt."""
import re


def rooms(root):
    """The rooms in their order, each with those that SEES names: {"core": [], "schema": ["core"], …}."""
    lists = (root / "sansmesh" / "CMakeLists.txt").read_text(encoding="utf-8")
    return {room: seen.split() for room, seen in re.findall(r"^sansmesh_room\((\w+)(?: SEES ([\w ]+))?\)", lists, re.MULTILINE)}
