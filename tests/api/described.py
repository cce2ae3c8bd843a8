"""The OpenAPI description with its shared parameters in place."""

from __future__ import annotations

from typing import Any

from tests.api.conftest import Client


def paths_with_parameters(atlas: Client) -> dict[str, Any]:
    """Return the paths of the description; references to parameters are replaced by these."""
    document = atlas.get("/openapi.json").json()
    shared = {
        f"#/components/parameters/{name}": parameter
        for name, parameter in document["components"].get("parameters", {}).items()
    }
    for item in document["paths"].values():
        for operation in item.values():
            if "parameters" in operation:
                operation["parameters"] = [
                    shared.get(parameter.get("$ref"), parameter)
                    for parameter in operation["parameters"]
                ]
    paths: dict[str, Any] = document["paths"]
    return paths
