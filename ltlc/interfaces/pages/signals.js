// Signals over time, with their limits.

class Signals extends Lanes {
  // The least and the greatest that is to be seen of a panel between two times.
  range(panel, from, to) {
    let low = Infinity, high = -Infinity;
    const take = (value) => {
      if (!Number.isFinite(value)) return;
      if (value < low) low = value;
      if (value > high) high = value;
    };
    if (panel.kind === "age") [0, age(panel.lines[0], Math.min(to, this.content.end))].forEach(take);
    for (const line of panel.lines) {
      const first = Math.max(0, upTo(line.times, from) - 1), end = upTo(line.times, to);
      for (const moved of line.role === "bound" ? [line.shift - line.reach, line.shift + line.reach] : [0]) {
        for (let i = first; i < end; i++) take(line.samples[i] + moved);
      }
    }
    if (from === -Infinity || low > high) {
      for (const { value, reach } of panel.limits) [value - reach, value + reach].forEach(take);
    }
    if (low > high) [low, high] = [0, 1];
    const room = (high - low) * 0.08 || Math.abs(high) * 0.1 || 1;
    return [low - room, high + room];
  }

  drawNumbers({ top, height, panel }) {
    const pen = this.pen;
    const [low, high] = this.fits ? this.range(panel, this.view.from, this.view.to) : panel.range;
    const y = (value) => {
      if (value === Infinity) return top;
      if (value === -Infinity) return top + height;
      return top + (high - value) / (high - low) * height;
    };
    const marks = this.scale(top, height, low, high, y);
    pen.fillStyle = colours.line;
    pen.globalAlpha = 0.5;
    for (const { at } of marks) pen.fillRect(0, at, this.width, 1);
    pen.globalAlpha = 1;
    for (const limit of panel.limits) this.drawLimit(limit, y);
    for (const line of panel.lines) {
      pen.strokeStyle = colours[line.role];
      pen.lineWidth = line.role === "bound" ? 1.25 : 1.5;
      pen.setLineDash(line.role === "bound" ? [5, 3] : []);
      if (panel.kind === "age") this.drawAge(line, y);
      else for (const reach of line.reach ? [-line.reach, line.reach] : [0]) {
        this.drawLine(line, (value) => y(value + (line.shift || 0) + reach));
      }
      pen.setLineDash([]);
    }
    this.drawFailure(panel, y);
    pen.textAlign = "left";
    pen.lineWidth = 3;
    for (const { at, label } of marks) {
      pen.strokeStyle = colours.surface;
      pen.strokeText(label, EDGE, at);
      pen.fillStyle = colours.quiet;
      pen.fillText(label, EDGE, at);
    }
    pen.lineWidth = 1;
  }

  // Where the numbers of a scale are written, from `low` to `high`.
  scale(top, height, low, high, y) {
    const step = niceStep((high - low) / Math.max(2, height / 30));
    const marks = [];
    for (let n = Math.ceil(low / step); n * step <= high; n++) {
      const at = Math.round(y(n * step));
      if (at < top + 6 || at > top + height - 6) continue;
      const label = Math.abs(n * step) >= 1e6 ? short(n * step) : (n * step).toFixed(Math.min(decimals(step), 9));
      marks.push({ at, label: label.replace("-", "−") });
    }
    return marks;
  }

  // The value on which the property was violated.
  drawFailure({ kind, lines: [line] }, y) {
    const failure = this.failure();
    const value = failure && (kind === "age" ? age : held)(line, failure.time);
    if (value === undefined || Number.isNaN(value)) return;
    const pen = this.pen;
    pen.beginPath();
    pen.arc(this.near(failure.time), y(value), 5, 0, 2 * Math.PI);
    pen.fillStyle = colours.violated;
    pen.fill();
    pen.lineWidth = 1.5;
    pen.strokeStyle = colours.surface;
    pen.stroke();
  }

  drawLimit({ value, reach }, y) {
    const pen = this.pen;
    if (reach) {
      pen.fillStyle = colours.limit;
      pen.globalAlpha = 0.14;
      pen.fillRect(0, y(value + reach), this.width, y(value - reach) - y(value + reach));
      pen.globalAlpha = 1;
    }
    pen.fillStyle = colours.limit;
    pen.fillRect(0, y(value) - 0.75, this.width, 1.5);
  }

  // Values are held until the next sample; of many in one column of pixels, the least and the greatest are drawn.
  drawLine(line, y) {
    const pen = this.pen, { times, samples } = line;
    const first = Math.max(0, upTo(times, this.view.from) - 1);
    const end = Math.min(times.length, upTo(times, this.view.to) + 1);
    pen.beginPath();
    if (end - first < 2 * this.width) this.traceEach(times, samples, first, end, y);
    else this.traceColumns(times, samples, first, end, y);
    pen.stroke();
    if (end - first < this.width / 8) this.drawDots(times, samples, first, end, y);
  }

  // It grows from each message, or the beginning, to the next one, or the end; the samples are what it has grown to.
  drawAge({ times, samples }, y) {
    const pen = this.pen, { from, to } = this.view;
    const rise = (start, end) => {
      const [first, last] = [Math.max(start, from), Math.min(end, to)];
      pen.moveTo(this.x(first), y((first - start) / 1e9));
      pen.lineTo(this.x(last), y((last - start) / 1e9));
    };
    pen.beginPath();
    for (let i = upTo(times, from), end = Math.min(times.length, upTo(times, to) + 1); i < end; i++) {
      rise(times[i] - samples[i] * 1e9, times[i]);
      if (times[i] <= to) pen.lineTo(this.x(times[i]), y(0));
    }
    const last = times.length ? times[times.length - 1] : 0;
    if (last < to) rise(last, this.content.end);
    pen.stroke();
  }

  traceEach(times, samples, first, end, y) {
    let isDown = false;
    for (let i = first; i < end; i++) {
      if (Number.isNaN(samples[i])) {
        if (isDown) this.pen.lineTo(this.near(times[i]), y(samples[i - 1]));
        isDown = false;
        continue;
      }
      const x = this.near(times[i]);
      if (isDown) this.pen.lineTo(x, y(samples[i - 1])); else this.pen.moveTo(x, y(samples[i]));
      this.pen.lineTo(x, y(samples[i]));
      isDown = true;
    }
    if (isDown && end === times.length) this.pen.lineTo(this.near(this.content.end), y(samples[end - 1]));
  }

  traceColumns(times, samples, first, end, y) {
    const scale = (this.width - 2 * EDGE) / (this.view.to - this.view.from);
    let column = NaN, low = 0, high = 0, last = NaN;
    const finish = () => {
      if (Number.isNaN(column)) return;
      this.pen.lineTo(column, y(high));
      this.pen.lineTo(column, y(low));
      this.pen.lineTo(column, y(last));
    };
    for (let i = first; i < end; i++) {
      const value = samples[i];
      if (Number.isNaN(value)) {
        finish();
        column = NaN;
        continue;
      }
      const x = Math.round(EDGE + (times[i] - this.view.from) * scale);
      if (x !== column) {
        finish();
        if (Number.isNaN(column)) this.pen.moveTo(x, y(value)); else this.pen.lineTo(x, y(last));
        column = x;
        low = high = value;
      } else if (value < low) low = value;
      else if (value > high) high = value;
      last = value;
    }
    finish();
  }

  drawDots(times, samples, first, end, y) {
    this.pen.fillStyle = this.pen.strokeStyle;
    for (let i = first; i < end; i++) {
      if (!Number.isNaN(samples[i])) this.pen.fillRect(this.near(times[i]) - 1.75, y(samples[i]) - 1.75, 3.5, 3.5);
    }
  }

  // Calls `show` for each stretch of time, as long as it can be seen, in which a value is held; null if several are.
  heldStretches({ times, samples }, show) {
    const end = upTo(times, this.view.to);
    let i = Math.max(0, upTo(times, this.view.from) - 1);
    while (i < end) {
      let next = i + 1, isOne = true;
      const soon = times[i] + (this.view.to - this.view.from) / this.width;
      while (next < end && (samples[next] === samples[i] || times[next] < soon)) {
        if (samples[next] !== samples[i]) isOne = false;
        if (!isOne && times[next] >= soon) break;
        next++;
      }
      show(isOne ? samples[i] : null, times[i], next < times.length ? times[next] : this.content.end);
      i = next;
    }
  }

  drawBoolean({ top, height, panel }) {
    const pen = this.pen;
    this.heldStretches(panel.lines[0], (value, from, to) => {
      const left = this.near(from), width = Math.max(this.near(to) - left, 1);
      const isHigh = value !== 0;
      pen.fillStyle = colours.signal;
      pen.globalAlpha = value === null ? 0.5 : 0.22;
      if (isHigh) pen.fillRect(left, top + 4, width, height - 8);
      pen.globalAlpha = 1;
      pen.fillRect(left, isHigh ? top + 3 : top + height - 5, width, 2);
      if (width > 40 && value !== null) {
        pen.fillStyle = colours.text;
        pen.textAlign = "left";
        pen.fillText(isHigh ? "true" : "false", Math.max(left, EDGE) + 6, top + height / 2);
      }
    });
  }

  drawString({ top, height, panel }) {
    const pen = this.pen;
    this.heldStretches(panel.lines[0], (value, from, to) => {
      const left = this.near(from), width = Math.max(this.near(to) - left, 1);
      const name = value === null ? "…" : panel.names[value] ?? "…";
      const isWanted = panel.wanted.includes(name);
      pen.fillStyle = isWanted ? colours.limit : colours.signal;
      pen.globalAlpha = isWanted ? 0.3 : 0.16;
      pen.fillRect(left, top + 3, Math.max(width - 1, 1), height - 6);
      pen.globalAlpha = 1;
      pen.fillRect(left, top + 3, 1, height - 6);
      if (width > 16) {
        pen.fillStyle = colours.text;
        pen.textAlign = "left";
        const start = Math.max(left, EDGE) + 6;
        pen.fillText(this.cut(name, left + width - start - 4), start, top + height / 2);
      }
    });
  }

  drawNews({ top, height, panel }) {
    const { times } = panel.lines[0], pen = this.pen;
    pen.fillStyle = colours.signal;
    let last = -1;
    for (let i = upTo(times, this.view.from), end = upTo(times, this.view.to); i < end; i++) {
      const x = Math.round(this.x(times[i]));
      if (x !== last) pen.fillRect(x, top + 3, 1.5, height - 6);
      last = x;
    }
  }

}
