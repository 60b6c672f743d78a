"""Exit with one line that says what to do unless this Python can hold the environment."""

import importlib.util
import sys

OLDEST, NEWEST = (3, 10), (3, 13)

found = '%s is Python %d.%d' % ((sys.executable,) + tuple(sys.version_info[:2]))
if not OLDEST <= sys.version_info[:2] <= NEWEST:
    sys.exit(found + ', but 3.10 to 3.13 is needed: name one of these, as in `make PYTHON=python3.12`.')
if not all(map(importlib.util.find_spec, ('venv', 'ensurepip'))):
    sys.exit(found + ' without venv: `apt install python3-venv` (Debian, Ubuntu), or name another with PYTHON=...')
