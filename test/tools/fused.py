#!/usr/bin/env python3
"""How many products fused into sums (vfmadd..., vfmsub..., vfnmadd..., vfnmsub...) are in programs for x86-64.

usage: fused.py PROGRAM ...: a line for each, its count and its name

Disassembling a whole program takes two seconds. So bytes are looked for that can be such an instruction, and functions that have them
are disassembled, from their first byte on.
"""
import bisect
import re
import subprocess
import sys
import tempfile


def of(condition):
    """A byte for which the condition holds, as a regular expression."""
    return b"[" + b"".join(b"\\x%02x" % value for value in range(256) if condition(value)) + b"]"


THREE = of(lambda code: 0x9 <= code >> 4 <= 0xB and code & 15 >= 6)    # of three operands: 96 to 9F, A6 to AF, B6 to BF
FOUR = of(lambda code: 0x5C <= code <= 0x5F or 0x68 <= code <= 0x6F or 0x78 <= code <= 0x7F)
PREFIX_66 = of(lambda byte: byte & 3 == 1)
# the first byte tells the encoding (VEX or EVEX), the second one the table of instructions
FUSED = re.compile(b"\xc4" + of(lambda byte: byte & 31 == 2) + PREFIX_66 + THREE +
                   b"|\xc4" + of(lambda byte: byte & 31 == 3) + PREFIX_66 + FOUR +
                   b"|\x62" + of(lambda byte: byte & 15 == 2) + of(lambda byte: byte & 7 == 5) + b"." + THREE, re.DOTALL)
APART = b"\x90"*16      # nothing is done between two functions


def said_by(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def suspects(program):
    """The functions of a program in which bytes look like a fused product."""
    size, address, offset = (int(word, 16) for word in
                             re.search(r" \.text +(\w+) +(\w+) +\w+ +(\w+)", said_by("objdump", "-h", program)).groups())
    with open(program, "rb") as file:
        file.seek(offset)
        text = file.read(size)
    starts = sorted({0, size} | {int(line.split()[0], 16) - address for line in said_by("nm", "--defined-only", program).splitlines()
                                 if line.split()[1] in "tTwWiu"})
    places = [match.start() for match in re.finditer(b"(?=" + FUSED.pattern + b")", text, re.DOTALL)]
    begin = {starts[bisect.bisect_right(starts, place) - 1] for place in places}
    return [text[first:starts[bisect.bisect_right(starts, first)]] for first in sorted(begin)]


def main():
    for program in sys.argv[1:]:
        with tempfile.NamedTemporaryFile() as file:
            file.write(APART + b"".join(function + APART for function in suspects(program)))
            file.flush()
            listing = said_by("objdump", "-D", "-b", "binary", "-m", "i386:x86-64", "--no-show-raw-insn", file.name)
        print(len(re.findall(r"\bvfn?m(?:add|sub)", listing)), program)


if __name__ == "__main__":
    main()
