"""What an editor asks about a specification: one file per question, knowing nothing of the protocol of editors.

Only `server` speaks that protocol. Places are spans of `ltlc.base.source`.
"""
