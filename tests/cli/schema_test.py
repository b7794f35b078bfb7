#!/usr/bin/env python3
"""Holds what `sansmesh schema` tells to tests/cli/schema.txt: a line for each option and each key of --json with its kind, unit, range and words, for
each surface, reconstruction of volumes, integrator and format. Programs, bindings and pages are made from it, so that a name which goes,
or changes its meaning, is seen here first.

  tests/cli/schema_test.py TOOL [--write]
"""
import json
import pathlib
import subprocess
import sys

KEPT = pathlib.Path(__file__).with_name("schema.txt")


def end_of(range_, end, excluded):
    return "" if range_[end] is None else f"{range_[end]:g}" + ("!" if range_[excluded] else "")


def line_of(option):
    parts = [",".join(option["names"]), option["kind"]]
    if "unit" in option:
        parts.append(f"[{option['unit']}]")
    if "range" in option:
        parts.append(f"{end_of(option['range'], 'least', 'above')}..{end_of(option['range'], 'most', 'below')}")
    if "choices" in option:
        parts.append("|".join(option["choices"]))
    if "implied" in option:
        parts.append(f"implied={option['implied']}")
    if "old_names" in option:
        parts.append("was " + ",".join(option["old_names"]))
    return " ".join(parts)


def lines_of(schema):
    yield f"schema {schema['schema']}"
    for kind in ("surfaces", "volume_methods"):
        for method in schema[kind]:
            yield f"{kind} {method['name']}: {' '.join(method['uses'])}".rstrip()
    for one in schema["flow_integrators"]:
        yield f"flow_integrators {one['name']}: order {one['order']}{' adaptive' if one['adaptive'] else ''} reach {one['reach']:g}"
    for one in schema["body_integrators"]:
        yield f"body_integrators {one['name']}{': implicit' if one['implicit'] else ''}"
    for found in schema["formats"]:
        writes = " ".join(f"{written['ending']}({','.join(written['holds'])})" for written in found["writes"])
        yield f"format {found['name']}: {','.join(found['endings'])} reads {','.join(found['reads']) or '-'} writes {writes or '-'}"
    for option in schema["common"]:
        yield f"every command: {line_of(option)}"
    for command in schema["commands"]:
        yield f"{command['name']}:"
        for option in command["options"]:
            yield f"  {line_of(option)}"
        for row in command["report"]:
            yield f"  tells {row['key']} {row['kind']}" + (f" [{row['unit']}]" if "unit" in row else "") + (
                f" {'|'.join(row['choices'])}" if "choices" in row else "")


def main():
    tool = sys.argv[1]
    found = subprocess.run([tool, "schema"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True).stdout
    lines = list(lines_of(json.loads(found)))
    if "--write" in sys.argv:
        KEPT.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return 0
    kept = KEPT.read_text(encoding="utf-8").splitlines()
    for line in sorted(set(kept) - set(lines)):
        print(f"gone: {line}")
    for line in sorted(set(lines) - set(kept)):
        print(f"new:  {line}")
    if lines == kept:
        return 0
    print(f"what `sansmesh schema` tells has changed. If that is meant: {sys.argv[0]} {tool} --write")
    return 1


if __name__ == "__main__":
    sys.exit(main())
