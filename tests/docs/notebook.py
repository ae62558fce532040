"""Runs the shipped notebook as Jupyter does; called as a program it writes what the cells give."""

from __future__ import annotations

import ast
import base64
import io
import json
from contextlib import redirect_stdout
from typing import Any

from matplotlib.figure import Figure

from designer.resources import example_file

FILE = example_file("yard").with_name("first-steps.ipynb")


def cells() -> list[dict[str, Any]]:
    return json.loads(FILE.read_text(encoding="utf-8"))["cells"]


def outputs_of(source: str, space: dict[str, Any], count: int) -> list[dict[str, Any]]:
    """Run a cell; return what it prints, and what its last line shows."""
    tree, value, printed = ast.parse(source), None, io.StringIO()
    last = tree.body[-1]
    with redirect_stdout(printed):
        if isinstance(last, ast.Expr):
            tree.body.pop()
            exec(compile(tree, "cell", "exec"), space)
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), space)
        else:
            exec(compile(tree, "cell", "exec"), space)
    outputs: list[dict[str, Any]] = []
    if printed.getvalue():
        text = printed.getvalue().splitlines(keepends=True)
        outputs.append({"output_type": "stream", "name": "stdout", "text": text})
    if value is not None:
        data: dict[str, Any] = {"text/plain": repr(value).splitlines(keepends=True)}
        if isinstance(value, Figure):
            picture = io.BytesIO()
            value.savefig(picture, format="png", dpi=80)
            data = {"image/png": base64.b64encode(picture.getvalue()).decode()}
        elif hasattr(value, "_repr_html_"):
            data["text/html"] = value._repr_html_().splitlines(keepends=True)
        result = {"output_type": "execute_result", "execution_count": count, "metadata": {}}
        outputs.append({**result, "data": data})
    return outputs


def run() -> list[dict[str, Any]]:
    """Return the cells with what they give."""
    space: dict[str, Any] = {}
    done, count = cells(), 0
    for cell in done:
        if cell["cell_type"] == "code":
            count += 1
            cell["execution_count"] = count
            cell["outputs"] = outputs_of("".join(cell["source"]), space, count)
    return done


if __name__ == "__main__":
    notebook = json.loads(FILE.read_text(encoding="utf-8"))
    notebook["cells"] = run()
    FILE.write_text(f"{json.dumps(notebook, indent=1, ensure_ascii=False)}\n", encoding="utf-8")
