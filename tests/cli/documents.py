"""Commands and fragments of scene files that the documents tell a reader to type."""

import os
import pathlib
import re

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
# The pages for users, and those for users and developers.
PAGES = ("README.md", *sorted(f"docs/{path.name}" for path in (SOURCE / "docs").glob("*.md")),
         "bindings/python/README.md", "tools/slurm/README.md")
MARKDOWN = (*PAGES, "CONTRIBUTING.md")
# A span of code in backquotes, which may contain a line break.
SPAN = re.compile(r"(?<!`)`((?:[^`\n]|\n(?!\n))+)`(?!`)")
# The beginning of a text that is typed into a shell.
PROGRAM = re.compile(
    r"(?:[A-Z_]+=\S+ )+\S+|(?:\w+=\$\()?"
    r"(?:sonject|sh|man|meson|ninja|python3|pip|doxygen|pkg-config|cmake|make|export|for|c\+\+|cc|"
    r"sbatch|scontrol|squeue|parallel|condor_submit|dask|\.?[\w-]+/[\w./-]+)(?= [^ ])"
)


def read(name):
    return (SOURCE / name).read_text(encoding="utf-8")


def spans(name):
    """Returns all texts between single backquotes, each once, in order."""
    return list(dict.fromkeys(" ".join(span.split()) for span in SPAN.findall(read(name))))


def blocks(name, language):
    """Returns the fenced blocks of code in that language."""
    return re.findall(rf"^```{language}\n(.*?)^```", read(name), flags=re.S | re.M)


def table_cells(name, heading):
    """Returns the first cells of the table whose first column has that heading."""
    (rows,) = re.findall(rf"^\| {heading} \|.*\n\|[-|]+\n((?:\|.*\n)+)", read(name), flags=re.M)
    return [row.split("|")[1].strip(" `") for row in rows.splitlines()]


def is_command(text):
    """True for a program with arguments. A folder, a file or a verb's name is no command."""
    if re.fullmatch(r"sonject \w+", text):
        return text == "sonject devices"
    return bool(PROGRAM.match(text)) or text in (".ci/run", ".ci/nightly")


def markdown_commands(name):
    """Returns all lines in blocks of code, and all spans in the text that begin with a program."""
    lines = [line for block in blocks(name, "sh") for line in block.splitlines()]
    lines += re.findall(r"^    (\S.*)$", re.sub(r"^```.*?^```", "", read(name), flags=re.S | re.M), flags=re.M)
    return lines + [span for span in spans(name) if is_command(span)]


def comment_commands(name):
    """Returns the comments of a YAML file that are indented by three spaces and begin with a program."""
    joined = read(name).replace("\\\n#", "")
    lines = re.findall(r"^#   (\S.*)$", joined, flags=re.M)
    return [re.sub(r"  +", " ", line.split(" # ")[0]) for line in lines if is_command(line)]


def suggested_settings(name):
    """Returns the settings that the comments of a scene propose behind --set."""
    comments = "\n".join(re.findall(r"^#.*$", read(name), flags=re.M))
    found = re.findall(r"--set (?:'([^']+)'|(\S+?=\"[^\"]+\")|(\S+?=[^\s,]+))", comments)
    return [next(filter(None, each)).replace('"', "").rstrip(".") for each in found]
