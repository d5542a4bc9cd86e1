#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Records a session: runs the commands of a page's console blocks, one after another in one shell, and writes down what they
print and how long they take, in place of what was there.

usage: record.py PAGE SHELL...     such as: record.py docs/transcripts/x.md chroot /somewhere /bin/bash

Of long output the beginning and the end are kept, and no line that names a host; the home folder is written ~. A
command goes on in lines that begin with "> ", as in a terminal."""
import pathlib
import re
import subprocess
import sys
import time

HEAD, TAIL = 4, 6
END = "--- end of command"


def run(shell, command):
    """Output, exit status and seconds."""
    started = time.monotonic()
    shell.stdin.write(f"{command}\nstatus=$?; echo; echo '{END}' $status\n")
    shell.stdin.flush()
    lines = []
    for line in shell.stdout:
        if line.startswith(END):
            while lines and not lines[-1].strip():
                lines.pop()
            return lines, int(line.split()[-1]), time.monotonic() - started
        lines.append(line.rstrip())
    sys.exit(f"the shell ended in: {command}")


def shortened(lines, home):
    lines = [line.split("\r")[-1].replace(home + "/", "~/") for line in lines if "://" not in line]
    if len(lines) > HEAD + TAIL + 1:
        lines[HEAD:-TAIL] = [f"[{len(lines) - HEAD - TAIL} more lines]"]
    return lines


def main():
    page = pathlib.Path(sys.argv[1])
    shell = subprocess.Popen(sys.argv[2:], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    home = run(shell, "echo $HOME")[0][0]
    total, failed = 0.0, []

    def record(block):
        nonlocal total
        out = ["```console"]
        for command in re.findall(r"^\$ (.*(?:\n>.*)*)", block[1], re.M):
            lines, status, seconds = run(shell, re.sub("\n> ?", "\n", command))
            total += seconds
            out += [f"$ {command}", *shortened(lines, home), f"[{seconds:.1f} s]"]
            print(f"{seconds:8.1f} s  {status}  {command}", flush=True)
            if status:
                failed.append(command)
                print("\n".join(lines[-20:]))
        return "\n".join(out + ["```"])

    text = re.sub(r"^```console\n(.*?)^```$", record, page.read_text(encoding="utf-8"), flags=re.M | re.S)
    text = re.sub(r"(?<=All commands together took )[^.\n]*", f"{total // 60:.0f} min {total % 60:.0f} s", text)
    page.write_text(text, encoding="utf-8")
    print(f"{total:.0f} s, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
