// What the pieces of a line are, as far as that can be seen without the grammar: for colours only.

const NAME = String.raw`[\p{L}_][\p{L}\p{N}_]*`;
const CONNECTIVE = String.raw`(?:and|or|implies)\b`;

// A function from a line to its pieces in order, each `[text, kind]`, null if it has no kind. The words are those of the language.
export function colouring({ keywords, contextual, functions, units }) {
  const oneOf = (words) => `(?:${words.join("|")})(?![\\p{L}\\p{N}_])`;
  const before = String.raw`(?<![\p{L}\p{N}_.])`;
  const kinds = {
    comment: "#.*",
    string: String.raw`"(?:\\.|[^"\\])*"?`,
    label: `(?<=^\\s*)${NAME}(?=\\s*:)`,
    topic: String.raw`(?<=\s)(?=[~/{])(?<=^\s*(?:decl|object|model|_\w+_\s*=)\s.*)[^\s#;,=()]*`,
    type: `(?<=\\s)(?<=^\\s*(?:decl|object)\\s+${NAME}\\s+[^\\s#;,=()]+\\s+)[^\\s#;,=()]+`,
    number: String.raw`${before}\d+(?:\.\d+)?(?:[eE][+-]?\d+)?(?:\s*${oneOf(units)})?`,
    keyword: `${before}(?:${oneOf(keywords)}|${oneOf(contextual)}(?=\\s*\\(|\\s+(?!${CONNECTIVE})[\\p{L}\\d_])|_\\w+_(?=\\s*=))`,
    function: `${before}${oneOf(functions)}(?=\\s*\\()`,
    name: `${NAME}(?:\\.${NAME})*`,
  };
  const pattern = new RegExp(Object.entries(kinds).map(([kind, text]) => `(?<${kind}>${text})`).join("|"), "gu");
  return (line) => {
    const pieces = [];
    let end = 0;
    for (const match of line.matchAll(pattern)) {
      const [kind] = Object.entries(match.groups).find(([, text]) => text !== undefined);
      if (match.index > end) pieces.push([line.slice(end, match.index), null]);
      pieces.push([match[0], kind === "name" ? null : kind]);
      end = match.index + match[0].length;
    }
    return end < line.length ? [...pieces, [line.slice(end), null]] : pieces;
  };
}
