"""A package's metadata besides its dependencies: version, maintainer and licence."""

from __future__ import annotations

from xml.etree import ElementTree

from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Metadata:
    """The elements of package.xml that a person fills in; `maintainers` are pairs of a name and an address."""

    version: str = "0.1.0"
    maintainers: tuple[tuple[str, str], ...] = (("TODO: maintainer", "todo@example.com"),)
    licenses: tuple[str, ...] = ("TODO: licence",)


def metadata_of(package_xml: str) -> Metadata:
    """What the user has filled in. Raises ValueError if it is not the package.xml of a package."""
    try:
        root = ElementTree.fromstring(package_xml)
    except ElementTree.ParseError as error:
        raise ValueError(f"not XML: {error}") from None
    maintainers = tuple((_text(each), each.get("email", "")) for each in root.iter("maintainer"))
    licenses = tuple(_text(each) for each in root.iter("license"))
    version = root.find("version")
    if root.tag != "package" or version is None or not maintainers or not licenses:
        raise ValueError("it has no version, maintainer or license")
    return Metadata(_text(version), maintainers, licenses)


def _text(element: ElementTree.Element) -> str:
    return (element.text or "").strip()
