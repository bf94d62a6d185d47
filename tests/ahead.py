"""Makes what takes long while tests are collected, which keeps one processor busy.

`python -m tests.ahead FOLDER`, where the workers look for it; what fails is made there once more.
"""

import sys
from pathlib import Path

from tests.docs.test_site import make
from tests.fixtures.once import made_in

if __name__ == "__main__":
    made_in(Path(sys.argv[1]), "site", make)
