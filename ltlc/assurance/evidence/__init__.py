"""Evidence: documents that say which verdict a recording has, for programs that share nothing with what found it."""
