"""`python -m innervate.cli` is `innervate`."""

import sys

from innervate.cli import main

sys.exit(main())
