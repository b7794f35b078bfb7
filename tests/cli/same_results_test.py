"""Tests of scripts/same-results: the tool beside itself differs in nothing, and beside one that does otherwise in just that.

  same_results_test.py TOOL"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TOOL = ""

TABLE = """
[quick]

convert tests/data/comments.off -o a.ply
convert a.ply -o b.stl
assess a.ply b.stl --samples 1000

csg 'box(1) - sphere(0.6)' -o part.ply --resolution 12
convert tests/data/soup.stl -o there/is/no/folder.ply
{more}

[full]

convert tests/data/comments.off -o full.ply
"""


class SameResults(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def wrapped(self, script):
        """A tool by a script of the shell, in which $TOOL is ours."""
        wrapper = self.folder / "wrapper"
        wrapper.write_text(f"#!/bin/bash\nTOOL={TOOL}\n{script}\n", encoding="utf-8")
        wrapper.chmod(0o755)
        return wrapper

    def compared(self, base, now, more="", options=("--quick",)):
        table = self.folder / "table"
        table.write_text(TABLE.format(more=more), encoding="utf-8")
        done = subprocess.run([ROOT / "scripts" / "same-results", "--tool-base", base, "--tool", now, "--cases", table, *options],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.stderr, "")
        return done.returncode, done.stdout

    def test_the_tool_beside_itself_differs_in_nothing(self):
        code, says = self.compared(TOOL, TOOL)
        self.assertIn("same-results: 5 cases, 3 files compared, 0 differ, 0 exempt, 0 skipped\n", says)
        self.assertIn("the same error with both: 1;", says)
        self.assertEqual(code, 0)

    def test_a_file_of_other_bytes_is_told_with_what_follows_from_it(self):
        other = self.wrapped('"$TOOL" "$@" $([[ $* == *"-o a.ply"* ]] && echo --ascii)')
        code, says = self.compared(TOOL, other)
        self.assertRegex(says, r"(?m)^convert tests/data/comments.off -o a.ply: a.ply: byte \d+ is the first that differs, "
                               r"[\d,]+ bytes, now [\d,]+$")
        self.assertEqual(re.findall(r"(\d+) differ, ", says), ["1"])
        self.assertEqual(code, 1)

    def test_another_exit_code_and_a_file_of_one_tool_alone_are_differences(self):
        other = self.wrapped('[[ $1 == csg ]] && { echo "nothing today"; exit 1; }\n"$TOOL" "$@"')
        code, says = self.compared(TOOL, other)
        self.assertIn("exit code 0, now 1: nothing today\n", says)
        self.assertIn("part.ply: written by the base alone\n", says)
        self.assertEqual(code, 1)

    def test_what_is_printed_and_exempt_files_may_differ(self):
        other = self.wrapped('"$TOOL" "$@"; code=$?; [[ $1 == csg ]] && echo >>part.ply; echo "and more"; exit $code')
        code, says = self.compared(TOOL, other, "may differ: part.p*")
        self.assertIn("exempt files that differ: 1", says)
        self.assertIn("same-results: 5 cases, 2 files compared, 0 differ, 1 exempt, 0 skipped\n", says)
        self.assertEqual(code, 0)

    def test_each_tool_gets_the_spelling_that_it_knows(self):
        other = self.wrapped('case $1 in\n'
                             '  help) "$TOOL" "$@" | sed "s/^  probe /  eval /; s/^  assess /  evaluate /" ;;\n'
                             '  assess) exit 2 ;;\n'
                             '  evaluate) shift; "$TOOL" assess "$@" ;;\n'
                             '  *) "$TOOL" "$@" ;;\n'
                             'esac')
        self.assertEqual(self.compared(TOOL, other)[0], 0)
        self.assertEqual(self.compared(other, TOOL)[0], 0)

    def test_what_the_base_does_not_know_is_skipped_with_what_follows(self):
        base = self.wrapped('[[ $1 == csg ]] && { echo "sansmesh: unknown command \'csg\'"; exit 2; }\n"$TOOL" "$@"')
        code, says = self.compared(base, TOOL)
        self.assertIn("2 skipped (2 not known to the base)\n", says)
        self.assertEqual(code, 0)

    def test_all_cases_are_run_but_with_quick(self):
        self.assertIn("same-results: 6 cases, 4 files", self.compared(TOOL, TOOL, options=())[1])
        self.assertIn("same-results: 1 cases, 1 files", self.compared(TOOL, TOOL, options=("--only", "full"))[1])


if __name__ == "__main__":
    TOOL = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
