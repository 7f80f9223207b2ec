"""Settings that all tests share."""

from hypothesis import settings

# Time varies with the load of the machine, and no test is about it.
settings.register_profile("ltlc", deadline=None)
settings.load_profile("ltlc")
