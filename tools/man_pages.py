"""Writes manual pages from the command's help: man_pages.py COMMAND FOLDER VERB ...

The pages in FOLDER are sonject.1, and sonject-VERB.1 for each verb.
"""

import pathlib
import re
import subprocess
import sys


def told(command, *arguments):
    return subprocess.run([command, *arguments], check=True, capture_output=True,
                          text=True).stdout


def roff(text):
    """Escapes a line so that roff prints it literally."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + escaped if escaped.startswith((".", "\\(aq")) else escaped


def paragraphs(text):
    return [part.split("\n") for part in text.strip("\n").split("\n\n")]


def head(name, version, summary):
    return [f'.TH {name.upper()} 1 "" "{version}" "User Commands"', ".nh", ".SH NAME",
            f"{roff(name)} \\- {roff(summary)}"]


def options(lines):
    """Makes entries of lines "  -o, --output DIR    what it is". The second column begins at index
    31, or after a longer first one."""
    made = []
    for line in lines:
        column = line.index(" ", 30)
        made += [".TP", f"\\fB{roff(line[2:column].rstrip())}\\fR", roff(line[column + 1:])]
    return made


def verbatim(title, lines):
    return [f".SH {title}", ".nf", *map(roff, lines), ".fi"]


def verb_page(verb, help_text, exit_lines, version):
    parts = paragraphs(help_text)
    (synopsis,), (summary,), rest = parts[0], parts[1], parts[2:]
    page = head(f"sonject-{verb}", version, summary) + [".SH SYNOPSIS", f"\\fB{roff(synopsis)}\\fR"]
    if rest and all(line.startswith("  ") for line in rest[0]):
        page += [".SH OPTIONS"] + options(rest.pop(0))
    for lines in rest:
        page += verbatim("NOTES", lines)
    return page + verbatim("EXIT STATUS", exit_lines) + [".SH SEE ALSO", ".BR sonject (1)"]


def command_page(help_text, verbs, version):
    parts = paragraphs(help_text)
    purpose = parts[0][0].removeprefix("sonject ").rstrip(".")
    page = head("sonject", version, purpose) + [".SH SYNOPSIS", "\\fBsonject\\fR \\fIVERB\\fR ..."]
    page += [".SH VERBS"]
    for line in parts[1]:
        verb, summary = re.fullmatch(r"  sonject (\S+) +(.*)", line).groups()
        page += [".TP", f"\\fB{roff(verb)}\\fR", roff(summary)]
    page += verbatim("HELP", parts[2]) + verbatim("EXIT STATUS", parts[-1])
    references = [f".BR sonject\\-{verb} (1)" for verb in verbs]
    return page + [".SH SEE ALSO"] + [line + "," for line in references[:-1]] + references[-1:]


def main():
    command, folder, verbs = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    version = told(command, "--version").strip()
    overview = told(command, "--help")
    pages = {"sonject": command_page(overview, verbs, version)}
    for verb in verbs:
        pages[f"sonject-{verb}"] = verb_page(verb, told(command, "help", verb),
                                             paragraphs(overview)[-1], version)
    for name, lines in pages.items():
        (folder / f"{name}.1").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
