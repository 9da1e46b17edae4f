#!/usr/bin/env python3
"""Takes the one block of a language out of a page.

usage: extract.py PAGE LANGUAGE OUTPUT
"""
import pathlib
import re
import sys


def main():
    page, language, output = sys.argv[1:]
    blocks = re.findall(rf"^```{re.escape(language)}\n(.*?)^```$", pathlib.Path(page).read_text(), re.M | re.S)
    if len(blocks) != 1:
        sys.exit(f"{page}: expected one block of {language}, found {len(blocks)}")
    pathlib.Path(output).write_text(blocks[0])


if __name__ == "__main__":
    main()
