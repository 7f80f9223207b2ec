"""`python -m ltlc` is the `ltlc` command."""

import sys

from ltlc.cli import main

sys.exit(main())
