"""Prints the type stub of the schemes' classes, which `cargo xtask write python` keeps."""

import spikewire as sw

HEAD = '''"""The classes of the schemes. Generated from the catalogue; a test says how when it has changed."""

from typing import Literal

from numpy.random import Generator

from ._arrays import Number, Numbers, Whole
from ._scheme import Scheme

'''

TYPES = {
    "number": "Number",
    "count": "Whole",
    "flag": "bool",
    "text": "str | Number | Numbers",
    "filter": "str | Numbers",
}


def argument(own):
    words = ", ".join(f'"{word}"' for word in own["words"])
    kind = f"Literal[{words}]" if words else TYPES[own["kind"]]
    if own["name"] == "seed":
        kind = "Whole | Generator"
    elif own["kind"] == "number":
        kind = "Number | Numbers"
    return f"        {own['name']}: {kind} | None = None,"


def stub():
    classes = []
    for scheme in sw.schemes.values():
        document = "\n".join(f"    {line}".rstrip() for line in scheme.__doc__.splitlines()).strip()
        arguments = "\n".join(argument(own) for own in scheme._info["parameters"])
        classes.append(f'''class {scheme.__name__}(Scheme):
    """{document}
    """

    def __init__(
        self,
        *,
{arguments}
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...
''')
    tail = "schemes: dict[str, type[Scheme]]\nNAMES: list[str]\n"
    return HEAD + "\n".join(classes) + "\n" + tail


if __name__ == "__main__":
    print(stub(), end="")
