"""Every small change of a module that a test should notice, each at one place of its text.

The changes are the usual ones of mutation testing (Offutt et al. 1996, "An experimental determination of sufficient
mutant operators"): comparisons, arithmetic, logic, conditions, numbers, what is returned, arguments and statements
left out. Strings, annotations and decorators are left alone: they say something to people and to the type checker.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

COMPARISONS: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: ("<=", ">="),
    ast.LtE: ("<", ">"),
    ast.Gt: (">=", "<="),
    ast.GtE: (">", "<"),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
}
"""What each comparison becomes: the other side of its boundary, and its opposite."""
ARITHMETIC: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.FloorDiv: "/",
    ast.Mod: "*",
    ast.Pow: "*",
    ast.BitAnd: "|",
    ast.BitOr: "&",
    ast.MatMult: "*",
}
"""What each operator becomes."""
FUNCTIONS = {"min": "max", "max": "min", "any": "all", "all": "any"}
"""Functions with an opposite."""
LARGER = 1.45
"""Numbers with a fraction become this many times as large: 2.9 for 2.0."""
_OPERATOR = re.compile(r"not\s+in|is\s+not|\bis\b|\bin\b|\band\b|\bor\b|[<>=!]=|[<>]|\*\*|//|[-+*/%&|@]")


@dataclass(frozen=True, order=True)
class Mutant:
    """One change of one module; `begin` and `end` are offsets into its bytes."""

    path: str
    begin: int
    end: int
    new: str
    first: int
    """First line of the statement that is changed, from 1."""
    last: int
    """Its last line, of a compound statement that of its head."""

    def apply(self, source: bytes) -> bytes:
        """The module's text with the change."""
        return source[: self.begin] + self.new.encode() + source[self.end :]

    def describe(self, source: bytes) -> str:
        """``path:line``, the line as it was and as it became."""
        changed = self.apply(source)
        number = source.count(b"\n", 0, self.begin)
        old, new = (text.splitlines()[number].decode().strip() for text in (source, changed))
        return f"{self.path}:{number + 1}\n    - {old}\n    + {new}"


@cache
def mutants_of(path: str, source: bytes) -> tuple[Mutant, ...]:
    """All mutants of a module, sorted, without those that do not parse or mean what the module means."""
    tree = ast.parse(source)
    original = ast.dump(tree)
    found = set()
    for mutant in _Finder(path, source).of(tree):
        try:
            changed = ast.dump(ast.parse(mutant.apply(source)))
        except SyntaxError:
            continue
        if changed != original:
            found.add(mutant)
    return tuple(sorted(found))


def _head(statement: ast.stmt) -> tuple[int, int]:
    """First and last line of a statement without those that it holds."""
    body = getattr(statement, "body", None) or getattr(statement, "cases", None)
    if not body:
        return statement.lineno, statement.end_lineno or statement.lineno
    inner = body[0].pattern if isinstance(body[0], ast.match_case) else body[0]
    return statement.lineno, max(statement.lineno, inner.lineno - 1)


class _Finder:
    def __init__(self, path: str, source: bytes) -> None:
        self.path = path
        self.source = source
        self.lines = (1, 1)
        self.starts = [0]
        for line in source.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def of(self, node: ast.AST) -> Iterator[Mutant]:
        """Mutants of a node and of all below it."""
        if isinstance(node, ast.JoinedStr):  # Python 3.11 does not say where the parts of f-strings lie.
            return
        if isinstance(node, ast.stmt):
            self.lines = _head(node)
        yield from self._here(node)
        for name, value in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list", "type_params"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from self.of(child)

    def _here(self, node: ast.AST) -> Iterator[Mutant]:
        match node:
            case ast.Compare():
                for left, operator, right in zip(
                    [node.left, *node.comparators[:-1]], node.ops, node.comparators, strict=True
                ):
                    for new in COMPARISONS[type(operator)]:
                        yield from self._between(left, right, new)
            case ast.BinOp() if type(node.op) in ARITHMETIC:
                yield from self._between(node.left, node.right, ARITHMETIC[type(node.op)])
            case ast.BoolOp():
                new = "or" if isinstance(node.op, ast.And) else "and"
                for left, right in zip(node.values, node.values[1:], strict=False):
                    yield from self._between(left, right, new)
            case ast.UnaryOp(op=ast.Not() | ast.USub()):
                yield self._replace(node, self._text(node.operand))
            case ast.Constant():
                yield from self._constant(node)
            case ast.Return(value=ast.expr() as value):
                yield self._replace(value, "None")
            case ast.Call():
                yield from self._call(node)
            case ast.Expr(value=ast.Call()):
                yield self._replace(node, "pass")
            case ast.AugAssign() if type(node.op) in ARITHMETIC:
                yield from self._between(node.target, node.value, ARITHMETIC[type(node.op)])
            case ast.Continue():
                yield self._replace(node, "break")
        yield from self._conditions(node)

    def _conditions(self, node: ast.AST) -> Iterator[Mutant]:
        """Conditions that are one name or call; the others have an operator that is changed."""
        tests = [node.test] if isinstance(node, (ast.If, ast.While, ast.IfExp)) else []
        tests += node.ifs if isinstance(node, ast.comprehension) else []
        for test in tests:
            if isinstance(test, (ast.Name, ast.Attribute, ast.Call, ast.Subscript)):
                yield self._replace(test, f"(not {self._text(test)})")

    def _constant(self, node: ast.Constant) -> Iterator[Mutant]:
        if isinstance(node.value, bool):
            yield self._replace(node, str(not node.value))
        elif isinstance(node.value, int):
            yield self._replace(node, str(node.value + 1))
        elif isinstance(node.value, float):
            yield self._replace(node, repr(node.value * LARGER if node.value else 1.0))

    def _call(self, node: ast.Call) -> Iterator[Mutant]:
        if isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS:
            yield self._replace(node.func, FUNCTIONS[node.func.id])
        parts: list[ast.expr | ast.keyword] = [*node.args, *node.keywords]
        if len(parts) < 2:
            return
        for number in range(max(1, len(node.args) - 1), len(parts)):
            kept = [self._text(part) for k, part in enumerate(parts) if k != number]
            begin, end = self._span(parts[0])[0], self._span(parts[-1])[1]
            yield self._mutant(begin, end, ", ".join(kept))

    def _between(self, left: ast.expr, right: ast.expr, new: str) -> Iterator[Mutant]:
        """Another operator between two operands."""
        begin, end = self._span(left)[1], self._span(right)[0]
        operator = _OPERATOR.search(self.source[begin:end].decode())
        if operator:
            yield self._mutant(begin + operator.start(), begin + operator.end(), new)

    def _replace(self, node: ast.expr | ast.stmt, new: str) -> Mutant:
        return self._mutant(*self._span(node), new)

    def _mutant(self, begin: int, end: int, new: str) -> Mutant:
        return Mutant(self.path, begin, end, new, *self.lines)

    def _span(self, node: ast.expr | ast.stmt | ast.keyword) -> tuple[int, int]:
        end = self.starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or node.col_offset)
        return self.starts[node.lineno - 1] + node.col_offset, end

    def _text(self, node: ast.expr | ast.keyword) -> str:
        begin, end = self._span(node)
        return self.source[begin:end].decode()
