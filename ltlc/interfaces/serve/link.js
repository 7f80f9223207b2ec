// What is on the page, in the part of its address that is never sent: so that it can be kept, and given to others.

const MOST = 30_000;

// Keep `state` in the address, as long as that is no longer than browsers and mail take.
export function keep(state) {
  const bytes = new TextEncoder().encode(JSON.stringify(state));
  const text = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
  const short = text.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  history.replaceState(null, "", short.length > MOST ? location.pathname : `#${short}`);
  return short.length <= MOST;
}

// What the address keeps: null if that is nothing, or nothing of ours.
export function kept() {
  try {
    const text = location.hash.slice(1).replaceAll("-", "+").replaceAll("_", "/");
    const state = JSON.parse(new TextDecoder().decode(Uint8Array.from(atob(text), (c) => c.charCodeAt(0))));
    return typeof state.text === "string" ? state : null;
  } catch {
    return null;
  }
}
