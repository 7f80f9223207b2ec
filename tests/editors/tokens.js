// Prints how the TextMate grammar colours each text of a JSON list on stdin: pieces of text, each with its scopes.
const fs = require("fs");
const oniguruma = require("vscode-oniguruma");
const { INITIAL, Registry, parseRawGrammar } = require("vscode-textmate");

async function main(grammarFile, texts) {
  await oniguruma.loadWASM(fs.readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm")));
  const registry = new Registry({
    onigLib: Promise.resolve(oniguruma),
    loadGrammar: async () => parseRawGrammar(fs.readFileSync(grammarFile, "utf8"), grammarFile),
  });
  const grammar = await registry.loadGrammar("source.ltlc");
  console.log(JSON.stringify(texts.map((text) => coloured(grammar, text))));
}

function coloured(grammar, text) {
  let state = INITIAL;
  return text.split("\n").flatMap((line) => {
    const { tokens, ruleStack } = grammar.tokenizeLine(line, state);
    state = ruleStack;
    const pieces = tokens.map((token) => [line.slice(token.startIndex, token.endIndex), token.scopes]);
    return [...pieces, ["\n", []]];
  });
}

main(process.argv[2], JSON.parse(fs.readFileSync(0, "utf8")));
