"""`ltlc certify`: certificates that someone else made, and code, checked against a specification.

Trusted are the front end, the encoding and the checker; neither Spot nor what made the certificates. What made the code
is not trusted either (`emitted_code`), nor what made the programs that code is printed from (`followed_programs`), nor
what judged recordings (`checked_evidence`).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from ltlc.assurance import evidence
from ltlc.assurance.afresh.files import Code, UnusableError, code_at, text_at
from ltlc.assurance.certificates import Checked, Subject, Unreadable, check_certificates
from ltlc.assurance.evidence.document import NotCovered, digest
from ltlc.assurance.evidence.statement import State
from ltlc.assurance.guards import check_guards
from ltlc.automata import Budget, SpotMissing
from ltlc.base.diagnostics import Diagnostic
from ltlc.compiler import Compiled
from ltlc.frontend.language import load_text, read_source
from ltlc.frontend.language.suppression import unsuppressed
from ltlc.interfaces.building.guards import NoRegionError, guard_entries, guard_programs
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.attesting import add_outputs, attest, refuse_unusable
from ltlc.interfaces.commands.checked_evidence import check_evidence, documents_at
from ltlc.interfaces.commands.common import FINDING, OK, UNDECIDED, UNUSABLE, failure, report, unusable
from ltlc.interfaces.commands.emitted_code import is_code_of
from ltlc.interfaces.commands.followed_programs import are_followed
from ltlc.interfaces.commands.progress import progress, saying
from ltlc.monitoring.campaigns.places import find
from ltlc.semantics.certificate_text import in_words
from ltlc.semantics.encodings import ENCODINGS, Encoding, encode
from ltlc.semantics.ltl import TRUE
from ltlc.semantics.region_text import guard_lines
from ltlc.specification.specification import Specification


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc certify` takes."""
    arguments.add_specification(parser)
    arguments.add_reading(parser)
    parser.add_argument(
        "certificate",
        metavar="CERTIFICATE",
        type=Path,
        nargs="?",
        help="the file of certificates; with --evidence they are made anew if it is omitted",
    )
    parser.add_argument(
        "--code",
        metavar="FILE",
        type=Path,
        help="emitted Python (a node or monitors), C next to its header, or the folder of a package: compare it with "
        "what ltlc emits for these monitors, and read it back",
    )
    parser.add_argument(
        "--program",
        action="store_true",
        help="also check that the programs that run follow these monitors; for certificates of `ltlc build --program`",
    )
    parser.add_argument(
        "--evidence",
        nargs="+",
        type=Path,
        metavar=("FILE", "RECORDING"),
        help="also check that the recordings have the verdicts that FILE states, which `ltlc run --evidence` wrote",
    )
    parser.add_argument(
        "--show-reader",
        action=_Reader,
        nargs=0,
        help="print the program that reads a recording anew for --evidence, to be run without ltlc, and exit",
    )
    add_outputs(parser)


class _Reader(argparse.Action):
    """Prints `recorded.py` as it is."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        sys.stdout.write((Path(evidence.__file__).parent / "recorded.py").read_text(encoding="utf-8"))
        parser.exit()


def run(options: argparse.Namespace) -> int:
    """Report what is certified, and what is checked by the certificates; 0 if all is right."""
    source = read_source(options.specification)
    encoding = ENCODINGS[options.encoding]
    places = find([str(path) for path in (options.evidence or [])[1:]])
    report(places.problems)
    if places.problems:
        return UNUSABLE
    recordings = places.paths
    specification, diagnostics = (
        (None, [source])
        if isinstance(source, Diagnostic)
        else load_text(source, options.msg_path, encoding, recordings)
    )
    report(unsuppressed(diagnostics))
    if specification is None:
        return failure(diagnostics)
    try:
        return _certify(options, specification, encoding, recordings)
    except (UnusableError, SpotMissing) as error:
        return unusable(str(error))


def _certify(
    options: argparse.Namespace, specification: Specification, encoding: Encoding, recordings: Sequence[Path]
) -> int:
    """Say of each property whether its certificate proves its monitor right, and check what was asked for."""
    refuse_unusable(options)
    documents = documents_at(options.evidence[0]) if options.evidence else ()
    text = _certificates(options, specification, encoding)
    code = None if options.code is None else code_at(options.code)
    subjects = [Subject(p.label, p.line, p.property, p.alphabet, options.encoding) for p in specification.properties]
    with saying("checking certificates", options.quiet):
        checked = check_certificates(subjects, text)
    if isinstance(checked, Unreadable):
        raise UnusableError(f"{options.certificate}:{checked.line}: {checked.message}")
    counting = {each.label for each in specification.properties if each.counts()}
    for each in checked:
        print(f"{each.label}: {_answer(each, each.label in counting)}")
        if each.assumption != TRUE:
            print(f"  assuming {in_words(each.assumption)}")
    is_right = all(each.passed for each in checked)
    if options.certificate is not None:
        is_right = _are_guarded(options, specification, checked, text) and is_right
    compiled = _compiled(specification, checked, encoding)
    if options.program:
        is_right = are_followed(checked, compiled, options.quiet) and is_right
    if code is not None:
        is_right = _is_code_of(code, compiled, specification, text, options.quiet) and is_right
    found = OK
    if documents:
        entries = {each.label: each.certified for each in checked if each.certified is not None}
        certificates = digest(text), entries
        found, claims = check_evidence(documents, specification, certificates, recordings, options.quiet)
        state = {OK: State.ACCEPTED, UNDECIDED: State.UNCHECKED}.get(found, State.REFUSED)
        results = list(zip(documents, claims, strict=True))
        found = max(found, attest(options, results, state, specification))
        if found == OK and any(isinstance(each, NotCovered) for document in documents for each in document.properties):
            found = UNDECIDED
    return found if is_right else FINDING


def _are_guarded(
    options: argparse.Namespace, specification: Specification, checked: Sequence[Checked], text: str
) -> bool:
    """Say of each guard whether its region is closed. Raises UnusableError."""
    found = check_guards(specification, checked, text, options.encoding)
    if isinstance(found, Unreadable):
        raise UnusableError(f"{options.certificate}:{found.line}: {found.message}")
    for guard in found:
        print(f"guard {guard.label}: {'certified' if guard.objection is None else f'not certified: {guard.objection}'}")
        for verb, labels in (("keeping", guard.keeps), ("relying on", guard.assumes)):
            if labels:
                print(f"  {verb} {', '.join(labels)}")
    return all(guard.objection is None for guard in found)


def _certificates(options: argparse.Namespace, specification: Specification, encoding: Encoding) -> str:
    """The text of the certificates that were given, or are made anew. Raises UnusableError and SpotMissing."""
    if options.certificate is not None:
        return text_at(options.certificate, "a certificate")
    if not options.evidence:
        raise UnusableError("give CERTIFICATE, or evidence with --evidence, for which certificates are made anew")
    from ltlc.assurance.evidence.certified import certificates
    from ltlc.compiler import compile_specification

    budget = Budget()
    with progress("making certificates", options.quiet) as watch:
        compiled, problems = compile_specification(specification, encoding, budget, watch)
        report(problems)
        return certificates(compiled, budget)[0]


def _answer(checked: Checked, counts: bool) -> str:
    if not checked.passed:
        return f"NOT certified: {checked.objection}"
    if counts and checked.answer.exact:
        return "certified, exactly except where only counting could decide"
    return "certified, exactly" if checked.answer.exact else "certified, but permanent verdicts may come late"


def _compiled(specification: Specification, checked: Sequence[Checked], encoding: Encoding) -> list[Compiled]:
    """Each property whose monitor is certified, with that monitor."""
    return [
        Compiled(each, encoding, encode(each.property, encoding), found.certified.certificate.monitor)
        for each, found in zip(specification.properties, checked, strict=False)  # others that are checked come last
        if found.certified is not None
    ]


def _is_code_of(code: Code, compiled: Sequence[Compiled], specification: Specification, text: str, quiet: bool) -> bool:
    """Say of each file of `code` whether it is what ltlc emits for the certified monitors, and what was read back.

    So it is of guards and their certified regions, which are in `text`. Raises UnusableError.
    """
    if len(compiled) < len(specification.properties):
        print("the code was not compared: not every property is certified")
        return False
    try:
        entries = guard_entries(specification, compiled)
        guards = guard_programs(specification, compiled, entries)
    except NoRegionError as error:
        raise UnusableError(str(error)) from None
    if not all("\n".join(guard_lines(each)) in text for each in entries):
        print("the code was not compared: the certificate has another region than guards that ltlc makes")
        return False
    return is_code_of(code, compiled, specification, quiet, guards)
