# ruff: noqa: D103 (the rule in the grammar says what each function makes)
"""The functions that make the syntax tree, one for each rule of `grammar.lark` that names one after `->`.

Each gets the parts of its rule, tokens included, and the span of them all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ltlc.base.source import Span
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import Token


def word(token: Token) -> syntax.Word:
    """A token as a node of the tree."""
    return syntax.Word(token.span, token.text)


def symbol(token: Token) -> syntax.Word:
    """An operator or keyword as a node of the tree, spelled as the language does."""
    return syntax.Word(token.span, token.terminal)


def token(_: Span, part: Token) -> Token:
    return part


def no_commands(_: Span) -> list[syntax.Command]:
    return []


def more_commands(_: Span, commands: list[syntax.Command], command: syntax.Command) -> list[syntax.Command]:
    commands.append(command)
    return commands


def first(_: Span, item: syntax.Node) -> list[syntax.Node]:
    return [item]


def more(_: Span, items: list[syntax.Node], *rest: Any) -> list[syntax.Node]:
    items.append(rest[-1])
    return items


def declaration(span: Span, _: Token, name: Token, topic: Token, type_: Token) -> syntax.Declaration:
    return syntax.Declaration(span, word(name), word(topic), word(type_))


def attribute(span: Span, name: Token, topic: Token, type_: Token) -> syntax.Declaration:
    return syntax.Declaration(span, word(name), word(topic), word(type_))


def model(
    span: Span, _: Token, name: Token, __: Token, attributes: list[syntax.Declaration], ___: Token
) -> syntax.Model:
    return syntax.Model(span, word(name), tuple(attributes))


def object_from_topic(span: Span, _: Token, name: Token, topic: Token, type_: Token) -> syntax.ObjectFromTopic:
    return syntax.ObjectFromTopic(span, word(name), word(topic), word(type_))


def object_at_place(span: Span, *parts: Any) -> syntax.ObjectAtPlace:
    _, name, _, _, x, _, y, _, z, _ = parts
    return syntax.ObjectAtPlace(span, word(name), (x, y, z))


def zone(span: Span, *parts: Any) -> syntax.Zone:
    _, name, _, _, corners, _ = parts
    return syntax.Zone(span, word(name), tuple(corners))


def corner(span: Span, *parts: Any) -> syntax.Corner:
    _, x, _, y, _ = parts
    return syntax.Corner(span, x, y)


def setting(span: Span, name: Token, _: Token, value: Token | syntax.Node) -> syntax.Setting:
    return syntax.Setting(span, word(name), word(value) if isinstance(value, Token) else value)


def association(span: Span, name: Token, _: Token, value: syntax.Node) -> syntax.Association:
    return syntax.Association(span, word(name), value)


def guard(span: Span, *parts: Any) -> syntax.Guard:
    _, raw, _, out, *fallbacks = parts
    return syntax.Guard(span, word(raw), word(out), tuple(map(word, fallbacks[1])) if fallbacks else ())


def message(span: Span, *parts: Any) -> syntax.Message:
    _, name, _, *constants, _ = parts
    return syntax.Message(span, word(name), tuple(*constants))


def constant(span: Span, name: Token, *parts: Any) -> syntax.Constant:
    *steps, _, value = parts
    path = reference(name.span.to(steps[0][-1].span) if steps else name.span, name, *steps)
    return syntax.Constant(span, path, value)


def assumed(span: Span, _: Token, command: syntax.PropertyCommand) -> syntax.PropertyCommand:
    return replace(command, span=span, is_assumed=True)


def labelled(span: Span, label: Token, _: Token, value: syntax.Node) -> syntax.PropertyCommand:
    return syntax.PropertyCommand(span, word(label), value)


def unlabelled(span: Span, value: syntax.Node) -> syntax.PropertyCommand:
    return syntax.PropertyCommand(span, None, value)


def required(_: Span, lines: list[syntax.AttributeLine], command: syntax.PropertyCommand) -> syntax.PropertyCommand:
    return replace(command, attributes=tuple(lines))


def attribute_line(span: Span, _: Token, entries: list[syntax.Entry], __: Token) -> syntax.AttributeLine:
    return syntax.AttributeLine(span, tuple(entries))


def entry(span: Span, key: Token, values: list[Token]) -> syntax.Entry:
    return syntax.Entry(span, word(key), tuple(map(word, values)))


def forall(span: Span, *parts: Any) -> syntax.Forall:
    _, variables, _, _, names, _, _, body = parts
    return syntax.Forall(span, tuple(map(word, variables)), tuple(map(word, names)), body)


def each(span: Span, *parts: Any) -> syntax.EachOf:
    _, variable, _, keys, *limit, _, body = parts
    return syntax.EachOf(span, word(variable), tuple(keys), _most(limit), body)


def each_message(span: Span, *parts: Any) -> syntax.EachMessage:
    _, news, *limit, _, body = parts
    return syntax.EachMessage(span, news, _most(limit), body)


def _most(limit: list[Token]) -> syntax.NumberLiteral | None:
    """The number of `limit N`, where that stands."""
    return syntax.NumberLiteral(limit[1].span, limit[1].text) if limit else None


def connective(span: Span, left: syntax.Node, operator: Token, right: syntax.Node) -> syntax.Connective:
    return syntax.Connective(span, left, symbol(operator), right)


def unary_temporal(span: Span, keyword: Token, argument: syntax.Node, *bound: syntax.Bound) -> syntax.Temporal:
    return syntax.Temporal(span, symbol(keyword), (argument,), *bound)


def binary_temporal(span: Span, *parts: Any) -> syntax.Temporal:
    keyword, event, _, body, *bound = parts
    return syntax.Temporal(span, symbol(keyword), (event, body), *bound)


def ternary_temporal(span: Span, *parts: Any) -> syntax.Temporal:
    keyword, opening, _, closing, _, body, *bound = parts
    return syntax.Temporal(span, symbol(keyword), (opening, closing, body), *bound)


def within(span: Span, *parts: Any) -> syntax.Within:
    _, duration, _, body, *bound = parts
    return syntax.Within(span, duration, body, *bound)


def bound(span: Span, keyword: Token, duration: syntax.Node) -> syntax.Bound:
    return syntax.Bound(span, symbol(keyword), duration)


def interval(span: Span, *parts: Any) -> syntax.Interval:
    _, start, _, end, _ = parts
    return syntax.Interval(span, start, end)


def stray_bound(span: Span, body: syntax.Node, bound: syntax.Bound) -> syntax.StrayBound:
    return syntax.StrayBound(span, body, bound)


def past(span: Span, keyword: Token, operand: syntax.Node, bound: syntax.Bound | None = None) -> syntax.Past:
    return syntax.Past(span, symbol(keyword), (operand,), bound)


def counted(span: Span, keyword: Token, operand: syntax.Node, times: Token, *bound: syntax.Bound) -> syntax.Past:
    return replace(past(span, keyword, operand, *bound), times=syntax.NumberLiteral(times.span, times.text))


def since(
    span: Span, kept: syntax.Node, keyword: Token, start: syntax.Node, bound: syntax.Bound | None = None
) -> syntax.Past:
    return syntax.Past(span, symbol(keyword), (kept, start), bound)


def negation(span: Span, _: Token, operand: syntax.Node) -> syntax.Negation:
    return syntax.Negation(span, operand)


def comparison(span: Span, left: syntax.Node, operator: Token, right: syntax.Node) -> syntax.Comparison:
    return syntax.Comparison(span, left, symbol(operator), right)


def comparison_with_margin(span: Span, *parts: Any) -> syntax.Comparison:
    left, operator, _, margin, _, right = parts
    return syntax.Comparison(span, left, symbol(operator), right, margin)


def rate(span: Span, *parts: Any) -> syntax.Rate:
    _, _, signal, _, operator, hertz, duration = parts
    return syntax.Rate(span, signal, symbol(operator), syntax.NumberLiteral(hertz.span, hertz.text), duration)


def membership(span: Span, *parts: Any) -> syntax.Membership:
    operand, operator, _, items, _ = parts
    return syntax.Membership(span, operand, symbol(operator), tuple(items))


def arithmetic(span: Span, left: syntax.Node, operator: Token, right: syntax.Node) -> syntax.Arithmetic:
    return syntax.Arithmetic(span, left, symbol(operator), right)


def minus(span: Span, _: Token, operand: syntax.Node) -> syntax.Minus:
    return syntax.Minus(span, operand)


def number(span: Span, part: Token) -> syntax.NumberLiteral:
    return syntax.NumberLiteral(span, part.text)


def duration(span: Span, part: Token) -> syntax.DurationLiteral:
    return syntax.DurationLiteral(span, *part.text.split())


def parameter(span: Span, _: Token) -> syntax.Parameter:
    return syntax.Parameter(span)


def news(span: Span, _: Token, signal: syntax.Node) -> syntax.News:
    return syntax.News(span, signal)


def gone(span: Span, _: Token, key: syntax.Node) -> syntax.Gone:
    return syntax.Gone(span, key)


def string(span: Span, part: Token) -> syntax.StringLiteral:
    return syntax.StringLiteral(span, part.text)


def boolean(span: Span, part: Token) -> syntax.BooleanLiteral:
    return syntax.BooleanLiteral(span, part.terminal == "true")


def message_constant(span: Span, message: Token, _: Token, name: Token) -> syntax.MessageConstant:
    return syntax.MessageConstant(span, word(message), word(name))


def call(span: Span, function: Token, _: Token, arguments: list[syntax.Node], __: Token) -> syntax.Call:
    return syntax.Call(span, word(function), tuple(arguments))


def quantified(span: Span, quantifier: Token, _: Token, condition: syntax.Node, __: Token) -> syntax.Quantified:
    return syntax.Quantified(span, word(quantifier), condition)


def quantified_over(span: Span, *parts: Any) -> syntax.Quantified:
    quantifier, _, condition, _, lists, _ = parts
    return syntax.Quantified(span, word(quantifier), condition, tuple(lists))


def list_of(_: Span, __: Token, arrays: list[syntax.Node], ___: Token) -> tuple[syntax.Node, ...]:
    return tuple(arrays)


def history(span: Span, *parts: Any) -> syntax.History:
    _, _, signal, _, offset, *otherwise, _ = parts
    return syntax.History(span, signal, offset, *otherwise[1:])


def recent(span: Span, *parts: Any) -> syntax.Recent:
    _, _, signal, _, offset, _, _ = parts
    return syntax.Recent(span, signal, offset)


def latch(span: Span, *parts: Any) -> syntax.Latch:
    _, _, signal, _, _, condition, _ = parts
    return syntax.Latch(span, signal, condition)


def parenthesised(span: Span, _: Token, inner: syntax.Node, __: Token) -> syntax.Node:
    return replace(inner, span=span)


def selection(span: Span, base: syntax.Node, steps: Sequence[syntax.Step]) -> syntax.Selection:
    return syntax.Selection(span, base, tuple(steps))


def reference(span: Span, name: Token, steps: Sequence[syntax.Step] = ()) -> syntax.Reference:
    return syntax.Reference(span, word(name), tuple(steps))


def member(_: Span, __: Token, name: Token) -> syntax.Word:
    return word(name)


def element(_: Span, __: Token, index: syntax.NumberLiteral, ___: Token) -> syntax.NumberLiteral:
    return index


def section(span: Span, *parts: Any) -> syntax.Range:
    _, start, _, stop, _ = parts
    return syntax.Range(span, start, stop)


def no_end(_: Span) -> None:
    return None


def negative_index(span: Span, _: Token, index: Token) -> syntax.NumberLiteral:
    return syntax.NumberLiteral(span, f"-{index.text}")
