// Questions to the server: of each kind the latest one only; an older one is given up, and its work ended there.

const asked = new Map();

export class Superseded extends Error {}

export async function ask(what, question, kind = what) {
  asked.get(kind)?.abort();
  const control = new AbortController();
  asked.set(kind, control);
  try {
    const response = await fetch(what, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: typeof question === "string" ? question : JSON.stringify(question),
      signal: control.signal,
    });
    const answer = await response.json();
    if (answer.error || answer.limit && Object.keys(answer).length === 1) throw new Error(answer.error || answer.limit);
    return answer;
  } catch (error) {
    if (control.signal.aborted) throw new Superseded();
    throw error instanceof TypeError ? new Error("the server does not answer: is `ltlc serve` still running?") : error;
  }
}

export function giveUp(kind) {
  asked.get(kind)?.abort();
}
