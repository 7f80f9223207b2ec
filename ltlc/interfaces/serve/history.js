// What can be undone: the states that the page was in before each edit, as text.

const MOST = 100, PAUSE = 700; // in ms: an edit of the same thing that comes sooner belongs to the one before

export class History {
  // `state` gives the state, `show` shows one again, `told` hears whenever what can be undone or redone is another.
  constructor(state, show, told) {
    Object.assign(this, { state, show, told, past: [], future: [], last: null });
  }

  // Somebody has edited `what`; null for an edit that stands by itself.
  edited(what = null) {
    const before = this.last, time = performance.now();
    const isSame = what !== null && what === this.what && time - this.time < PAUSE;
    Object.assign(this, { what, time });
    this.settle();
    if (before === null || before === this.last || isSame) return;
    this.past = [...this.past, before].slice(-MOST);
    this.future = [];
    this.told();
  }

  // The state has changed as a consequence of an edit.
  settle() {
    this.last = JSON.stringify(this.state());
  }

  undo() {
    this.go(this.past, this.future);
  }
  redo() {
    this.go(this.future, this.past);
  }
  go(from, to) {
    if (!from.length) return;
    to.push(this.last);
    this.last = from.pop();
    this.what = null;
    this.show(JSON.parse(this.last));
    this.told();
  }
}
