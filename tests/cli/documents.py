"""What the documents tell a reader to type: commands, and fragments of scene files."""

import os
import pathlib
import re

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
# What users read, and with it what developers do.
PAGES = ("README.md", *sorted(f"docs/{path.name}" for path in (SOURCE / "docs").glob("*.md")),
         "bindings/python/README.md", "tools/slurm/README.md")
MARKDOWN = (*PAGES, "CONTRIBUTING.md")
# A paragraph may be wrapped within one.
SPAN = re.compile(r"(?<!`)`((?:[^`\n]|\n(?!\n))+)`(?!`)")
# What begins so is typed into a shell.
PROGRAM = re.compile(
    r"(?:[A-Z_]+=\S+ )+\S+|(?:\w+=\$\()?"
    r"(?:sonject|sh|man|meson|ninja|python3|pip|doxygen|pkg-config|cmake|make|export|for|c\+\+|cc|"
    r"sbatch|scontrol|squeue|parallel|condor_submit|dask|\.?[\w-]+/[\w./-]+)(?= [^ ])"
)


def read(name):
    return (SOURCE / name).read_text(encoding="utf-8")


def spans(name):
    """All that stands between single backquotes, each once, in order."""
    return list(dict.fromkeys(" ".join(span.split()) for span in SPAN.findall(read(name))))


def blocks(name, language):
    """The fenced blocks of code in that language."""
    return re.findall(rf"^```{language}\n(.*?)^```", read(name), flags=re.S | re.M)


def table_cells(name, heading):
    """The first cells of the table whose first column has that heading."""
    (rows,) = re.findall(rf"^\| {heading} \|.*\n\|[-|]+\n((?:\|.*\n)+)", read(name), flags=re.M)
    return [row.split("|")[1].strip(" `") for row in rows.splitlines()]


def is_command(text):
    """A program with arguments; not a folder, a file or a verb's name."""
    if re.fullmatch(r"sonject \w+", text):
        return text == "sonject devices"
    return bool(PROGRAM.match(text)) or text in (".ci/run", ".ci/nightly")


def markdown_commands(name):
    """In blocks of code, all lines; in the text what begins with a program."""
    lines = [line for block in blocks(name, "sh") for line in block.splitlines()]
    lines += re.findall(r"^    (\S.*)$", re.sub(r"^```.*?^```", "", read(name), flags=re.S | re.M), flags=re.M)
    return lines + [span for span in spans(name) if is_command(span)]


def comment_commands(name):
    """Of a YAML file, comments that are set in by three spaces and begin with a program."""
    joined = read(name).replace("\\\n#", "")
    lines = re.findall(r"^#   (\S.*)$", joined, flags=re.M)
    return [re.sub(r"  +", " ", line.split(" # ")[0]) for line in lines if is_command(line)]


def suggested_settings(name):
    """What the comments of a scene propose behind --set."""
    comments = "\n".join(re.findall(r"^#.*$", read(name), flags=re.M))
    found = re.findall(r"--set (?:'([^']+)'|(\S+?=\"[^\"]+\")|(\S+?=[^\s,]+))", comments)
    return [next(filter(None, each)).replace('"', "").rstrip(".") for each in found]
