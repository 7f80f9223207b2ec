// A timeline: lanes one below the other, and what people do with them.

const PAPER = 720; // how wide a timeline is drawn for paper

class Timeline extends Signals {
  constructor(element, content, view) {
    super();
    Object.assign(this, { element, content, view });
    this.canvas = element.querySelector("canvas");
    this.output = element.querySelector("output");
    this.isVisible = this.isWanted = this.fits = false;
    this.cursor = null;
    this.depths = content.episodes.reduce((most, each) => Math.max(most, each.depth + 1), 0);
    this.lanes = this.layOut();
    view.timelines.push(this);
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    new IntersectionObserver(([entry]) => {
      this.isVisible = entry.isIntersecting;
      if (this.isVisible) this.load();
    }, { rootMargin: "200px" }).observe(this.canvas);
    this.listen();
  }

  layOut() {
    let top = 0;
    const lane = (height, draw, title, legend = []) => {
      const made = { top: top + HEAD, height, draw, title, legend };
      top += HEAD + height + GAP;
      return made;
    };
    const lanes = [lane(BAND, this.drawVerdicts, "verdict")];
    if (this.content.violations.length > 1) lanes.push(lane(BAR, this.drawViolations, "violations"));
    if (this.depths) lanes.push(lane(this.depths * (BAR + 2), this.drawEpisodes, "episodes"));
    if (this.content.deadlines.length) lanes.push(lane(BAR, this.drawDeadlines, "obligation open, and its deadline"));
    for (const panel of this.content.panels) {
      const draw = { number: this.drawNumbers, boolean: this.drawBoolean, string: this.drawString, news: this.drawNews,
        age: this.drawNumbers };
      const made = lane(HEIGHTS[panel.kind], draw[panel.kind], panel.title, this.legend(panel));
      lanes.push(Object.assign(made, { panel }));
    }
    this.height = top + AXIS;
    this.canvas.style.height = `${this.height}px`;
    return lanes;
  }

  legend(panel) {
    const brief = (text) => (text.startsWith(`${panel.title} `) ? text.slice(panel.title.length + 1) : text);
    const limits = panel.limits.map((limit) => ["limit", brief(limit.text)]);
    const bounds = panel.lines.filter((line) => line.role === "bound").map((line) => ["bound", brief(line.text)]);
    const wanted = panel.wanted.map((name) => ["limit", `= ${name}`]);
    return [...limits, ...bounds, ...wanted];
  }

  async load() {
    if (!this.loading) {
      this.loading = Promise.all(this.content.panels.flatMap(
        (panel) => panel.lines.map(panel.kind === "age" ? readAge : readLine)));
      await this.loading;
      for (const panel of this.content.panels) panel.range = this.range(panel, -Infinity, Infinity);
      this.isLoaded = true;
      this.tell();
    }
    this.redraw();
  }

  resize() {
    if (asShown) return; // on paper, whose layout is none of ours
    this.size(this.canvas.clientWidth, window.devicePixelRatio || 1);
    this.redraw();
  }

  size(width, ratio) {
    this.width = width;
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
  }

  // Paper shows what nobody has scrolled to.
  print() {
    this.size(PAPER, 2);
    if (this.isLoaded) this.draw();
  }

  redraw() {
    if (this.isWanted || !this.isVisible || !this.isLoaded) return;
    this.isWanted = true;
    requestAnimationFrame(() => {
      this.isWanted = false;
      this.draw();
    });
  }

  draw() {
    const pen = this.pen = this.canvas.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.fillStyle = colours.surface;
    pen.fillRect(0, 0, this.width, this.height);
    pen.font = FONT;
    pen.textBaseline = "middle";
    this.drawGrid();
    this.drawMoments();
    for (const lane of this.lanes) {
      pen.save();
      pen.beginPath();
      pen.rect(0, lane.top - 1, this.width, lane.height + 2);
      pen.clip();
      if (lane.panel) this.drawAreas(lane);
      lane.draw.call(this, lane);
      pen.restore();
      this.drawTitle(lane);
    }
    this.drawCursor();
    this.element.dataset.drawn = String(Number(this.element.dataset.drawn || 0) + 1);
  }

  point(time) {
    this.cursor = time;
    this.tell();
    this.redraw();
  }

  // What there is at the pointer, or else where the property was violated, or at the end.
  tell() {
    const time = this.cursor ?? this.failure()?.time ?? this.content.end;
    this.output.textContent = this.isLoaded ? this.told(time) : "";
  }

  told(time) {
    const { clock, changes, panels, episodes } = this.content;
    const places = Math.min(9, decimals((this.view.to - this.view.from) / 1e9 / this.width) + 1);
    const said = [`${clock.since ? "+" : ""}${((clock.zero + time) / 1e9).toFixed(places)} s`];
    const change = changes.filter((each) => each.time <= time).at(-1);
    said.push((change ? change.verdict : "not_started").replace("_", " "));
    const open = episodes.filter((each) => each.from <= time && time < this.ended(each.to));
    for (const episode of open) said.push(`in ${episode.scope}`);
    for (const panel of panels) if (panel.kind !== "news") said.push(`${panel.title}: ${this.toldValue(panel, time)}`);
    return said.join(" · ");
  }

  toldValue(panel, time) {
    if (panel.kind === "age") return `${short(age(panel.lines[0], time))} s`;
    const value = held(panel.lines[0], time);
    if (value === undefined) return "no value yet";
    if (panel.kind === "boolean") return value ? "true" : "false";
    return panel.kind === "string" ? panel.names[value] ?? "…" : short(value);
  }

  // --- what people do ---

  listen() {
    const { canvas, view } = this;
    const pointers = new Map();
    const at = (event) => event.clientX - canvas.getBoundingClientRect().left;
    canvas.addEventListener("wheel", (event) => this.wheel(event, at(event)), { passive: false });
    canvas.addEventListener("dblclick", () => view.reset());
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, at(event));
      canvas.classList.add("dragged");
    });
    canvas.addEventListener("pointermove", (event) => {
      scrolled = 0;
      if (pointers.has(event.pointerId)) this.drag(pointers, event.pointerId, at(event));
      this.point(Math.min(Math.max(this.time(at(event)), 0), this.content.end));
    });
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => {
        pointers.delete(event.pointerId);
        canvas.classList.remove("dragged");
      });
    }
    canvas.addEventListener("pointerleave", () => this.point(null));
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.element.querySelectorAll("[data-do]").forEach((tool) => {
      tool.addEventListener(tool.type === "checkbox" ? "change" : "click", () => this.act(tool.dataset.do));
    });
  }

  // A page that is being scrolled goes on being scrolled, until the pointer moves.
  wheel(event, x) {
    const isOut = event.deltaY > 0;
    if (performance.now() - scrolled < 400 || (isOut && this.view.isWhole)) return;
    event.preventDefault();
    if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) this.view.move(event.deltaX / this.width);
    else this.view.zoom(Math.exp(Math.min(Math.max(event.deltaY, -120), 120) * 0.0025), this.time(x));
  }

  drag(pointers, id, x) {
    const before = pointers.get(id);
    const other = [...pointers].find(([each]) => each !== id);
    if (other) {
      const factor = (before - other[1]) / (x - other[1] || 1);
      if (factor > 0) this.view.zoom(Math.min(Math.max(factor, 0.5), 2), this.time(other[1]));
    } else this.view.move((before - x) / (this.width - 2 * EDGE));
    pointers.set(id, x);
  }

  key(event) {
    const keys = { "+": "in", "=": "in", "-": "out", 0: "reset", Home: "reset", n: "next", p: "previous",
      ArrowLeft: "left", ArrowRight: "right" };
    if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.act(keys[event.key]);
  }

  act(what) {
    const actions = {
      in: () => this.view.zoom(0.5, this.kept()),
      out: () => this.view.zoom(2, this.kept()),
      reset: () => this.view.reset(),
      left: () => this.view.move(-0.2),
      right: () => this.view.move(0.2),
      next: () => this.go(1),
      previous: () => this.go(-1),
      fit: () => { this.fits = !this.fits; this.redraw(); },
    };
    actions[what]();
  }

  // The moment that stays where it is: the cursor, or else the violation, if it is shown; otherwise the middle.
  kept() {
    const { from, to } = this.view;
    return [this.cursor ?? undefined, this.failure()?.time].find((time) => time >= from && time <= to);
  }

  // Show the next change of verdict, or the one before, in the middle.
  go(direction) {
    const { view, content } = this;
    const now = this.cursor ?? (direction > 0 ? -1 : content.end + 1);
    const times = content.changes.map((change) => change.time);
    const found = direction > 0 ? times.find((time) => time > now) : times.filter((time) => time < now).at(-1);
    if (found === undefined) return;
    const half = Math.min(view.to - view.from, view.end / 4) / 2;
    view.show(found - half, found + half);
    this.point(found);
  }
}
