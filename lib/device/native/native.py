"""Writes the C file that builds an entry point's kernels for the processor itself.

usage: native.py ENTRY.cl OUTPUT.c

Each instruction set and variant compiles the file once. -DNATIVE_PROGRAM names the table of kernels.
"""
import pathlib
import re
import sys


def arguments_of(text):
    """Yields the types of a kernel's arguments. Buffers are pointers."""
    for argument in " ".join(text.replace("__global", "").split()).split(","):
        yield re.fullmatch(r"\s*(.*?)\s*\b\w+\s*", argument).group(1)


def main():
    entry, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    text = entry.read_text(encoding="utf-8")
    kernels = re.findall(r"__kernel void (\w+)\((.*?)\)\n\{", text, re.DOTALL)
    of_trace = re.search(r"#define TRACE_ARGUMENTS(.*?[^\\])\n", (entry.parent / "trace.h").read_text(encoding="utf-8"), re.DOTALL)
    kernels += [(name, of_trace.group(1).replace("\\", "")) for name in re.findall(r"TRACE_KERNEL\((\w+),", text)]
    lines = ['#include "device/native/entry.h"', f'#include "{entry.name}"', ""]
    for name, arguments in kernels:
        values = ", ".join(f"*({type_name} const *)arguments[{i}].value" for i, type_name in enumerate(arguments_of(arguments)))
        lines += [
            f"static void run_{name}(const struct kernel_argument *arguments, const size_t *global, size_t first, size_t end)", "{",
            "    native_item_begin(global, first);",
            "    for (size_t item = first; item < end; item++, native_item_next(global))",
            f"        {name}({values});", "}", ""]
    lines += ["extern const struct native_kernel NATIVE_PROGRAM[];", "const struct native_kernel NATIVE_PROGRAM[] = {",
              *(f'    {{"{name}", run_{name}}},' for name, _ in kernels), "    {NULL, NULL}};", ""]
    output.write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
