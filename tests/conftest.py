"""Settings that all tests share."""

import os

from hypothesis import settings

# Time varies with the load of the machine, and no test is about it. In CI the same commit gets the same answer; new
# examples are found where developers run the tests.
settings.register_profile("ltlc", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("ltlc")
