"""`ltlc certify`: certificates that someone else made, checked against a specification.

Trusted are the front end, the encoding and the checker; neither Spot nor what made the certificates.
"""

from __future__ import annotations

import argparse

from ltlc.assurance.certificates import Checked, Subject, Unreadable, check_certificates
from ltlc.commands.common import FINDING, OK, failure, report, unusable
from ltlc.language import load
from ltlc.semantics.certificate_text import in_words
from ltlc.semantics.encodings import ENCODINGS
from ltlc.semantics.ltl import TRUE


def run(options: argparse.Namespace) -> int:
    """Say of each property whether its certificate proves its monitor right; 0 if all do."""
    specification, diagnostics = load(options.specification, options.msg_path, ENCODINGS[options.encoding])
    report(diagnostics)
    if specification is None:
        return failure(diagnostics)
    try:
        text = options.certificate.read_text(encoding="utf-8")
    except OSError as error:
        return unusable(f"{options.certificate} cannot be read: {error.strerror or error}")
    except UnicodeDecodeError:
        return unusable(f"{options.certificate} is not a certificate: it is not UTF-8 text")
    subjects = [Subject(p.label, p.line, p.property, p.alphabet, options.encoding) for p in specification.properties]
    checked = check_certificates(subjects, text)
    if isinstance(checked, Unreadable):
        return unusable(f"{options.certificate}:{checked.line}: {checked.message}")
    for each in checked:
        print(f"{each.label}: {_answer(each)}")
        if each.assumption != TRUE:
            print(f"  assuming {in_words(each.assumption)}")
    return OK if all(each.passed for each in checked) else FINDING


def _answer(checked: Checked) -> str:
    if not checked.passed:
        return f"NOT certified: {checked.objection}"
    return "certified, exactly" if checked.answer.exact else "certified, but not that every permanent verdict is given"
