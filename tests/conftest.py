"""Settings that all tests share, and what those need that meet other nodes."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from ros_support import Network, own_domain

# Time varies with the load of the machine, and no test is about it. In CI the same commit gets the same answer; new
# examples are found where developers run the tests.
settings.register_profile("ltlc", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("ltlc")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the nodes of a module are, which hear each other and nobody else."""
    folder = tmp_path_factory.mktemp("nodes")
    with own_domain(folder):
        yield folder


@pytest.fixture
def network(folder: Path) -> Iterator[Network]:
    """Another node, of the test's own."""
    network = Network()
    yield network
    network.close()
