// What is drawn of a property itself: its verdicts, episodes and deadlines, with the grid of time behind them.

class Lanes {
  x(time) {
    return EDGE + (time - this.view.from) / (this.view.to - this.view.from) * (this.width - 2 * EDGE);
  }
  time(x) {
    return this.view.from + (x - EDGE) / (this.width - 2 * EDGE) * (this.view.to - this.view.from);
  }
  // Where `time` is drawn if it may be far outside: canvases do not like large numbers.
  near(time) {
    return Math.min(Math.max(this.x(time), -50), this.width + 50);
  }

  drawTitle({ top, title, legend }) {
    const pen = this.pen;
    pen.textAlign = "left";
    pen.font = `600 ${FONT}`;
    pen.fillStyle = colours.text;
    let x = EDGE;
    const write = (text, colour) => {
      const shown = this.cut(text, this.width - x - EDGE);
      pen.lineWidth = 4;
      pen.strokeStyle = colours.surface;
      pen.strokeText(shown, x, top - 10);
      pen.fillStyle = colours[colour];
      pen.fillText(shown, x, top - 10);
      x += pen.measureText(shown).width + 14;
    };
    write(title, "text");
    pen.font = FONT;
    for (const [colour, text] of legend) if (x < this.width - 60) write(`— ${text}`, colour);
  }

  cut(text, width) {
    if (this.pen.measureText(text).width <= width) return text;
    let length = Math.max(0, Math.floor(text.length * width / this.pen.measureText(text).width) - 1);
    while (length > 0 && this.pen.measureText(`${text.slice(0, length)}…`).width > width) length--;
    return length > 0 ? `${text.slice(0, length)}…` : "";
  }

  ticks() {
    const seconds = (this.view.to - this.view.from) / 1e9;
    return niceStep(seconds / Math.max(2, this.width / 110));
  }

  drawGrid() {
    const pen = this.pen, step = this.ticks();
    const zero = this.content.clock.zero / 1e9;
    const sign = this.content.clock.since ? "+" : "";
    const bottom = this.height - AXIS;
    pen.textAlign = "center";
    for (let n = Math.ceil((this.view.from / 1e9 + zero) / step); ; n++) {
      const time = (n * step - zero) * 1e9;
      if (time > this.view.to) break;
      const x = Math.round(this.x(time)) + 0.5;
      pen.fillStyle = colours.line;
      pen.globalAlpha = 0.6;
      pen.fillRect(x - 0.5, HEAD, 1, bottom - HEAD);
      pen.globalAlpha = 1;
      pen.fillStyle = colours.quiet;
      const label = `${sign}${(n * step).toFixed(Math.min(decimals(step), 9))}`.replace("-", "−");
      const half = pen.measureText(label).width / 2;
      if (x - half > 0 && x + half < this.width - 24) pen.fillText(label, x, bottom + 13);
    }
    pen.textAlign = "right";
    pen.fillStyle = colours.quiet;
    pen.fillText("s", this.width - EDGE, bottom + 13);
  }

  // Calls `show` with each stretch of time that has a verdict.
  stretches(show) {
    const { changes, end } = this.content;
    let from = 0, verdict = "not_started";
    for (const change of changes) {
      if (change.time > from) show(verdict, from, change.time);
      from = change.time;
      verdict = change.verdict;
    }
    show(verdict, from, Math.max(end, from));
  }

  drawBand(top, height, from, to, colour, text) {
    const pen = this.pen, left = this.near(from), right = Math.max(this.near(to), left + 1.5);
    if (right < 0 || left > this.width) return;
    pen.fillStyle = colours[colour];
    pen.fillRect(left, top, right - left, height);
    if (right - left < 24) return;
    const start = Math.max(left, EDGE);
    pen.fillStyle = colours[`${colour}-text`] || colours.text;
    pen.textAlign = "left";
    const shown = this.cut(text, Math.min(right, this.width) - start - 12);
    if (shown.length > 2 || shown === text) pen.fillText(shown, start + 6, top + height / 2 + 0.5);
  }

  drawVerdicts({ top, height }) {
    this.stretches((verdict, from, to) => {
      this.drawBand(top, height, from, to, verdict, verdict.replace("_", " "));
    });
  }

  drawEpisodes({ top }) {
    for (const episode of this.content.episodes) {
      this.drawBand(top + episode.depth * (BAR + 2), BAR, episode.from, this.ended(episode.to), "episode", episode.scope);
    }
  }

  drawViolations({ top }) {
    for (const each of this.content.violations) this.drawBand(top, BAR, each.from, each.to, "violated", each.text);
  }

  // When what has no end ended: with the property, or with the run.
  ended(to) {
    if (to !== null) return to;
    const last = this.content.changes.at(-1);
    return last && ["violated", "satisfied"].includes(last.verdict) ? last.time : this.content.end;
  }

  drawDeadlines({ top }) {
    const pen = this.pen, middle = top + BAR / 2;
    for (const deadline of this.content.deadlines) {
      const left = this.near(deadline.from), due = this.near(deadline.due), to = this.near(this.ended(deadline.to));
      if (Math.max(due, to) < 0 || left > this.width) continue;
      pen.fillStyle = colours["owed-area"];
      pen.fillRect(left, top + 2, due - left, BAR - 4);
      pen.fillStyle = colours.owed;
      pen.globalAlpha = 0.75;
      pen.fillRect(left, top + 5, Math.max(to - left, 1.5), BAR - 10);
      pen.globalAlpha = 1;
      pen.beginPath();
      pen.moveTo(due, middle - 7);
      pen.lineTo(due + 6, middle);
      pen.lineTo(due, middle + 7);
      pen.lineTo(due - 6, middle);
      pen.fill();
    }
  }

  // Behind the signals: the time in which an episode is open, or something owed.
  drawAreas({ top, height }) {
    const pen = this.pen;
    pen.lineWidth = 1;
    const fill = (colour, from, to) => {
      const left = this.near(from);
      pen.fillStyle = colours[colour];
      pen.fillRect(left, top, this.near(to) - left, height);
    };
    for (const episode of this.content.episodes) {
      if (episode.depth === 0) fill("episode-area", episode.from, this.ended(episode.to));
    }
    for (const deadline of this.content.deadlines) {
      fill("owed-area", deadline.from, deadline.due);
      pen.strokeStyle = colours.owed;
      pen.setLineDash([3, 3]);
      pen.beginPath();
      pen.moveTo(this.near(deadline.due), top);
      pen.lineTo(this.near(deadline.due), top + height);
      pen.stroke();
      pen.setLineDash([]);
    }
  }

  drawMoments() {
    const failure = this.failure();
    if (!failure) return;
    this.pen.fillStyle = colours.violated;
    this.pen.fillRect(Math.round(this.near(failure.time)) - 0.75, HEAD, 1.5, this.height - AXIS - HEAD);
  }

  failure() {
    return this.content.changes.find((change) => change.verdict === "violated");
  }

  drawCursor() {
    if (this.cursor === null) return;
    const x = Math.round(this.x(this.cursor)) + 0.5;
    this.pen.strokeStyle = colours.text;
    this.pen.lineWidth = 1;
    this.pen.globalAlpha = 0.6;
    this.pen.beginPath();
    this.pen.moveTo(x, HEAD);
    this.pen.lineTo(x, this.height - AXIS);
    this.pen.stroke();
    this.pen.globalAlpha = 1;
  }

}
