"""The matrix as ReqIF 1.2 (OMG), which tools for requirements exchange: objects, and relations `verifies` between them.

ReqIF has to have times of change. They are that of the environment variable SOURCE_DATE_EPOCH, or otherwise now.
"""

from __future__ import annotations

import os
from datetime import UTC, datetime
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from ltlc.base.revision import version_text
from ltlc.monitoring.matrix.forms import results_text
from ltlc.monitoring.matrix.matrix import Matrix
from ltlc.monitoring.matrix.needs import test_ids
from ltlc.runtime.reports import printable

NAMESPACE = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd"

_MOST = 1_000_000
"""Characters of a value."""

_OF_REQUIREMENT = ("ReqIF.ForeignID", "ReqIF.Text", "State")
_OF_PROPERTY = ("ReqIF.ForeignID", "ReqIF.Name", "ReqIF.Text", "Place", "Specification SHA-256", "State", "Results")
"""The attributes of objects; those that begin with `ReqIF.` are named as tools expect them."""


def reqif(matrix: Matrix) -> str:
    """An object for each requirement and each property, which verifies requirements; all in one specification."""
    return _Writer(matrix).text()


class _Writer:
    def __init__(self, matrix: Matrix) -> None:
        epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
        now = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdecimal() else datetime.now(UTC)
        self.matrix, self.time = matrix, now.isoformat(timespec="seconds")
        self.ids = {each.id: f"requirement-{n}" for n, each in enumerate(matrix.requirements)}
        self.properties = dict(zip(test_ids(matrix), matrix.properties, strict=True))

    def text(self) -> str:
        root = Element("REQ-IF", xmlns=NAMESPACE)
        header = SubElement(SubElement(root, "THE-HEADER"), "REQ-IF-HEADER", IDENTIFIER="header")
        for name, value in (
            ("CREATION-TIME", self.time),
            ("REQ-IF-TOOL-ID", f"ltlc {version_text()}"),
            ("REQ-IF-VERSION", "1.0"),
            ("SOURCE-TOOL-ID", f"ltlc {version_text()}"),
            ("TITLE", "Requirements and the properties that verify them"),
        ):
            SubElement(header, name).text = value
        content = SubElement(SubElement(root, "CORE-CONTENT"), "REQ-IF-CONTENT")
        types = SubElement(content, "DATATYPES")
        self._named(types, "DATATYPE-DEFINITION-STRING", "string", "String").set("MAX-LENGTH", str(_MOST))
        self._types(SubElement(content, "SPEC-TYPES"))
        objects = SubElement(content, "SPEC-OBJECTS")
        for each in self.matrix.requirements:
            values = (each.id, each.text, each.state.value)
            self._object(objects, self.ids[each.id], "requirement", dict(zip(_OF_REQUIREMENT, values, strict=True)))
        for id, of in self.properties.items():
            told = (id, of.label, of.text, of.place, of.source.sha256, of.state.value, results_text(of))
            self._object(objects, id, "property", dict(zip(_OF_PROPERTY, told, strict=True)))
        relations = SubElement(content, "SPEC-RELATIONS")
        for id, of in self.properties.items():
            for verified in of.ids:
                self._relation(relations, id, self.ids[verified])
        self._specification(SubElement(content, "SPECIFICATIONS"))
        ElementTree.indent(root)
        return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"

    def _named(self, parent: Element, tag: str, id: str, name: str) -> Element:
        return SubElement(parent, tag, {"IDENTIFIER": id, "LAST-CHANGE": self.time, "LONG-NAME": name})

    def _types(self, parent: Element) -> None:
        """The kinds of objects, the kind of relation, and that of the specification."""
        for kind, name, attributes in (
            ("requirement", "Requirement", _OF_REQUIREMENT),
            ("property", "Property", _OF_PROPERTY),
        ):
            made = SubElement(self._named(parent, "SPEC-OBJECT-TYPE", kind, name), "SPEC-ATTRIBUTES")
            for attribute in attributes:
                of = self._named(made, "ATTRIBUTE-DEFINITION-STRING", _attribute(kind, attribute), attribute)
                SubElement(SubElement(of, "TYPE"), "DATATYPE-DEFINITION-STRING-REF").text = "string"
        self._named(parent, "SPEC-RELATION-TYPE", "verifies", "verifies")
        self._named(parent, "SPECIFICATION-TYPE", "matrix", "Matrix")

    def _object(self, parent: Element, id: str, kind: str, values: dict[str, str]) -> None:
        made = SubElement(parent, "SPEC-OBJECT", {"IDENTIFIER": id, "LAST-CHANGE": self.time})
        told = SubElement(made, "VALUES")
        for name, value in values.items():
            one = SubElement(told, "ATTRIBUTE-VALUE-STRING", {"THE-VALUE": printable(value)[:_MOST]})
            definition = SubElement(one, "DEFINITION")
            SubElement(definition, "ATTRIBUTE-DEFINITION-STRING-REF").text = _attribute(kind, name)
        SubElement(SubElement(made, "TYPE"), "SPEC-OBJECT-TYPE-REF").text = kind

    def _relation(self, parent: Element, source: str, target: str) -> None:
        made = SubElement(parent, "SPEC-RELATION", {"IDENTIFIER": f"{source}-{target}", "LAST-CHANGE": self.time})
        for end, id in (("SOURCE", source), ("TARGET", target)):
            SubElement(SubElement(made, end), "SPEC-OBJECT-REF").text = id
        SubElement(SubElement(made, "TYPE"), "SPEC-RELATION-TYPE-REF").text = "verifies"

    def _specification(self, parent: Element) -> None:
        made = self._named(parent, "SPECIFICATION", "specification", "Requirements and properties")
        SubElement(SubElement(made, "TYPE"), "SPECIFICATION-TYPE-REF").text = "matrix"
        children = SubElement(made, "CHILDREN")
        for id in (*self.ids.values(), *self.properties):
            place = SubElement(children, "SPEC-HIERARCHY", {"IDENTIFIER": f"place-{id}", "LAST-CHANGE": self.time})
            SubElement(SubElement(place, "OBJECT"), "SPEC-OBJECT-REF").text = id


def _attribute(kind: str, name: str) -> str:
    return f"{kind}.{name.removeprefix('ReqIF.').replace(' ', '-')}"
