"""Reads the declarations of the public headers, as far as the tests compare them."""

import ctypes
import pathlib
import re

from sonject import _structures

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "include" / "sonject"

SCALARS = {
    "double": ctypes.c_double,
    "float": ctypes.c_float,
    "int": ctypes.c_int,
    "size_t": ctypes.c_size_t,
    "int32_t": ctypes.c_int32,
    "uint32_t": ctypes.c_uint32,
    "uint64_t": ctypes.c_uint64,
}
POINTERS = {
    "const char *": ctypes.c_char_p,
    "char **": ctypes.POINTER(ctypes.c_char_p),
    "const char *const *": ctypes.POINTER(ctypes.c_char_p),
    "void *": ctypes.c_void_p,
    "const void *": ctypes.c_void_p,
    "const uint8_t *": ctypes.POINTER(ctypes.c_uint8),
}


def source():
    """All headers, without comments, one space between words."""
    text = "\n".join(path.read_text() for path in sorted(FOLDER.glob("*.h")))
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    for name, value in re.findall(r"#define (SONJECT_\w+_CAPACITY)\s+(\d+)", text):
        text = text.replace(f"[{name}]", f"[{value}]")
    return re.sub(r"\s+", " ", text)


def enumerations():
    """{name: {member: value}}"""
    found = re.findall(r"typedef enum (\w+) \{(.*?)\} (\w+);", source())
    assert all(tag == name for tag, _, name in found)
    return {
        name: {
            member: int(value) for member, value in re.findall(r"(\w+) = (\d+)", body)
        }
        for _, body, name in found
    }


def c_type(text, enumeration_names):
    """The ctypes type that a C type's spelling stands for."""
    text = text.strip()
    if text in POINTERS:
        return POINTERS[text]
    if text in SCALARS:
        return SCALARS[text]
    if text in enumeration_names:
        return ctypes.c_int
    base, stars = re.fullmatch(r"(?:const )?(\w+) ?(\**)", text).groups()
    kind = SCALARS.get(base) or getattr(_structures, base)
    for _ in stars:
        kind = ctypes.POINTER(kind)
    return kind


def split(declaration):
    """Type, name and array length of "const char *name", "char name[64]", ..."""
    kind, name, length = re.fullmatch(r"(.*?)(\w+)(?:\[(\d+)\])?", declaration.strip()).groups()
    return kind, name, length


def structures():
    """{name: [(field, ctypes type)]}"""
    names = enumerations()
    found = {}
    for tag, body, name in re.findall(r"typedef struct (\w+) \{(.*?)\} (\w+);", source()):
        assert tag == name
        found[name] = []
        for declaration in body.split(";")[:-1]:
            kind, field, length = split(declaration)
            if length:
                element = ctypes.c_char if kind.strip() == "char" else c_type(kind, names)
                found[name].append((field, element * int(length)))
            else:
                found[name].append((field, c_type(kind, names)))
    return found


def functions():
    """{name: (what it returns, [parameter types])}"""
    names = enumerations()
    found = {}
    for result, name, parameters in re.findall(
        r"SONJECT_API ((?:const )?\w+ \*?)(\w+)\((.*?)\);", source()
    ):
        kinds = []
        if parameters.strip() != "void":
            kinds = [c_type(split(each)[0], names) for each in parameters.split(",")]
        returned = None if result.strip() == "void" else c_type(result, names)
        found[name] = (returned, kinds)
    return found


def declaration_count():
    """How often SONJECT_API stands before a declaration."""
    return len(re.findall(r"SONJECT_API (?!__)[\w *]+\(", source()))


def callbacks():
    """{name: (what it returns, [parameter types])} of the function pointer types."""
    names = enumerations()
    found = {}
    for result, name, parameters in re.findall(
        r"typedef (\w+) \(\*(\w+)\)\((.*?)\);", source()
    ):
        kinds = [c_type(split(each)[0], names) for each in parameters.split(",")]
        found[name] = (None if result == "void" else c_type(result, names), kinds)
    return found
