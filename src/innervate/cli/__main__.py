"""`python -m innervate.cli` is `innervate`."""

import sys

from innervate.cli.app import main

sys.exit(main())
