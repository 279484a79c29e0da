"""Loads the repository's Python programs, which have no suffix, as modules."""

import importlib.machinery
import importlib.util
import pathlib

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]


def load(name):
    path = str(REPOSITORY / "scripts" / name)
    loader = importlib.machinery.SourceFileLoader(name, path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module
