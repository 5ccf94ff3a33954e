"use strict";
// The table of a sweep's cases: filter, sort, open one; the figures follow.
(async () => {
  const { byId, show } = page;
  const { figures, columns, curves, files } = await page.begin();
  const count = columns[0].values.length, each = 25;
  const shown = columns.filter((column) => column.shown);
  const filters = new Map(columns.map((column) => [column, ""]));
  let order = { column: columns[0], down: false }, left = [], start = 0, open = null;

  const text = (column, row) => {
    const value = column.values[row];
    if (typeof value !== "number") return value ?? "–";
    return Number(value.toPrecision(column.digits)).toString().replace("-", "−");
  };
  const head = (column) => column.words + (column.unit ? `, ${column.unit}` : "");
  const make = (tag, properties = {}, ...inner) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...inner);
    return element;
  };

  // ---- filters --------------------------------------------------------------------------------------------------------
  const test = (column, filter) => { // whether a value passes a filter; null where the filter cannot be understood
    const said = filter.trim().replace("−", "-");
    if (said === "") return () => true;
    if (!column.numeric) return (value) => String(value ?? "").toLowerCase().includes(said.toLowerCase());
    const number = "(-?[\\d.]+(?:e-?\\d+)?)";
    let parts = said.match(new RegExp(`^${number}\\s*\\.\\.\\s*${number}$`, "i"));
    if (parts) return (value) => value >= Number(parts[1]) && value <= Number(parts[2]);
    parts = said.match(new RegExp(`^(<=|>=|<|>)\\s*${number}$`, "i"));
    const bound = parts && Number(parts[2]);
    if (parts) return { "<": (v) => v < bound, ">": (v) => v > bound, "<=": (v) => v <= bound, ">=": (v) => v >= bound }[parts[1]];
    if (!new RegExp(`^${number}$`, "i").test(said)) return null;
    const digits = said.replace(/e.*$/i, "").replace(/[^\d]/g, "").replace(/^0+/, "").length || 1;
    return (value) => Number(value.toPrecision(digits)) === Number(said);
  };
  const sieve = () => {
    const tests = [];
    for (const [column, filter] of filters) {
      const one = test(column, filter);
      byId(`filter-${columns.indexOf(column)}`)?.setAttribute("aria-invalid", String(one === null));
      if (one && filter.trim()) tests.push((row) => column.values[row] !== null && one(column.values[row]));
    }
    const { column, down } = order, sign = down ? -1 : 1;
    const rows = Array.from({ length: count }, (_, row) => row).filter((row) => tests.every((one) => one(row)));
    rows.sort((a, b) => { // what has no value comes last
      const [u, v] = [column.values[a], column.values[b]];
      if (u === null || v === null) return (u === null) - (v === null) || a - b;
      return (u < v ? -sign : u > v ? sign : 0) || a - b;
    });
    left = rows;
    start = 0;
    list();
    plot();
  };

  // ---- the table ------------------------------------------------------------------------------------------------------
  const table = byId("cases"), body = table.tBodies[0];
  const heads = () => {
    const names = make("tr"), fields = make("tr");
    shown.forEach((column, place) => {
      const button = make("button", { type: "button", className: "sort" }, head(column));
      const cell = make("th", { scope: "col" }, button);
      cell.setAttribute("aria-sort", order.column !== column ? "none" : order.down ? "descending" : "ascending");
      button.addEventListener("click", () => {
        order = { column, down: order.column === column && !order.down };
        table.tHead.rows[0].querySelectorAll("th").forEach((other) => other.setAttribute("aria-sort", "none"));
        cell.setAttribute("aria-sort", order.down ? "descending" : "ascending");
        sieve();
      });
      names.append(cell);
      const field = make("input", { type: "search", id: `filter-${columns.indexOf(column)}`, value: filters.get(column), size: 9 });
      field.setAttribute("aria-label", `filter ${head(column)}`);
      field.addEventListener("input", () => { filters.set(column, field.value); sieve(); });
      fields.append(make("td", {}, field));
    });
    table.tHead.replaceChildren(names, fields);
  };
  const list = () => {
    const rows = left.slice(start, start + each).map((row) => {
      const button = make("button", { type: "button", className: "open" }, String(columns[0].values[row]));
      button.setAttribute("aria-label", `open case ${columns[0].values[row]}`);
      button.addEventListener("click", () => unfold(row, true));
      const cells = shown.slice(1).map((column) => make("td", {}, text(column, row)));
      const line = make("tr", { className: row === open ? "chosen" : "" }, make("th", { scope: "row" }, button), ...cells);
      return line;
    });
    body.replaceChildren(...rows);
    byId("count").textContent = `${left.length} of ${count} cases`;
    byId("where").textContent = left.length ? `${start + 1} to ${Math.min(start + each, left.length)}` : "none";
    byId("back").disabled = start === 0;
    byId("on").disabled = start + each >= left.length;
  };
  // A link to a blob of the cases that pass the filters, with all columns, made when it is used.
  // A word that a spreadsheet would take for a formula gets an apostrophe.
  const plain = (value) => typeof value === "string" && /^\s*[=+\-@]./.test(value) && Number.isNaN(+value) ? `'${value}` : String(value);
  const quoted = (value) => /[",\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value;
  const csv = () => [columns.map((column) => column.name), ...left.map((row) => columns.map((column) => column.values[row] ?? ""))]
    .map((cells) => cells.map((cell) => quoted(plain(cell))).join(",")).join("\n") + "\n";
  let blob = null;
  byId("table").addEventListener("click", () => {
    if (blob) URL.revokeObjectURL(blob);
    byId("table").href = blob = URL.createObjectURL(new Blob([csv()], { type: "text/csv" }));
  });
  byId("back").addEventListener("click", () => { start -= each; list(); });
  byId("on").addEventListener("click", () => { start += each; list(); });
  byId("clear").addEventListener("click", () => { for (const key of filters.keys()) filters.set(key, ""); heads(); sieve(); });
  columns.slice(1).forEach((column) => {
    const box = make("input", { type: "checkbox", checked: column.shown });
    box.addEventListener("change", () => {
      column.shown = box.checked;
      shown.splice(0, shown.length, ...columns.filter((one) => one.shown));
      heads();
      list();
    });
    byId("columns").append(make("label", {}, box, ` ${head(column)}`));
  });

  // ---- one case -------------------------------------------------------------------------------------------------------
  const put = (group, entry, value) => {
    const path = entry.split("."), last = path.pop();
    for (const part of path) group = group[part] ??= {};
    group[last] = value;
  };
  const file = (row) => {
    const data = structuredClone(files.base);
    for (const [name, entries] of Object.entries(files.entries)) {
      const value = columns.find((column) => column.name === name).values[row];
      for (const entry of entries) put(data, entry, structuredClone(files.choices[name]?.[value] ?? value));
    }
    return JSON.stringify(data, null, 2) + "\n"; // which is YAML, too
  };
  const unfold = (row, go) => {
    open = row;
    const number = columns[0].values[row], reason = columns.find((column) => column.name === "reason").values[row];
    byId("one").hidden = false;
    byId("one-title").textContent = `Case ${number}`;
    byId("reason").hidden = !reason;
    byId("reason").textContent = reason;
    const lines = columns.slice(1).filter((column) => column.name !== "reason");
    byId("numbers").replaceChildren(...lines.map((column) =>
      make("tr", {}, make("th", { scope: "row" }, head(column)), make("td", {}, text(column, row)))));
    byId("file").hidden = files === null;
    if (files !== null) {
      const name = `case-${number}`;
      byId("case").textContent = file(row);
      byId("file").querySelector(".file").textContent = byId("save").download = `${name}.yaml`;
      byId("file").querySelector(".command").textContent = `coilset solve ${name}.yaml`;
      byId("file").querySelector(".report").textContent = `coilset report results/${name}`;
      page.offer(byId("case").textContent);
    }
    list();
    plot();
    if (go) {
      byId("one-title").focus({ preventScroll: true });
      byId("one").scrollIntoView({ behavior: "auto", block: "start" });
    }
  };
  byId("close").addEventListener("click", () => {
    const number = columns[0].values[open];
    open = null;
    byId("one").hidden = true;
    list();
    plot();
    (body.querySelector(`[aria-label="open case ${number}"]`) ?? byId("clear")).focus();
  });

  // ---- the figures ----------------------------------------------------------------------------------------------------
  const axes = { x: byId("x"), y: byId("y"), c: byId("c") };
  const numeric = columns.filter((column) => column.numeric);
  for (const [role, select] of Object.entries(axes)) {
    select.append(...numeric.map((column) => make("option", { value: columns.indexOf(column) }, head(column))));
    select.value = columns.findIndex((column) => column.role === role);
    if (select.value === "") select.selectedIndex = 0;
    select.addEventListener("change", () => plot());
  }
  const plot = () => {
    const [x, y, c] = ["x", "y", "c"].map((role) => columns[Number(axes[role].value)]);
    const pick = (column, rows) => rows.map((row) => column.values[row]);
    const dots = {
      type: "scatter", mode: "markers", x: pick(x, left), y: pick(y, left), customdata: left, showlegend: false,
      text: left.map((row) => `case ${columns[0].values[row]}`),
      hovertemplate: "%{text}<br>%{x:.5g}, %{y:.5g}, %{marker.color:.5g}<extra></extra>",
      marker: { size: 7, color: pick(c, left), colorscale: "Viridis", showscale: true, line: { width: 0.7, color: "#808080" },
        colorbar: { title: { text: head(c), side: "right" }, thickness: 14 } },
    };
    const ring = open === null ? [] : [{
      type: "scatter", mode: "markers", x: [x.values[open]], y: [y.values[open]], hoverinfo: "skip", showlegend: false,
      marker: { size: 15, symbol: "circle-open", line: { width: 3 }, color: "#d55e00" },
    }];
    show(byId("over"), [dots, ...ring], { xaxis: { title: { text: head(x) } }, yaxis: { title: { text: head(y) } } });
    if (open !== null && curves) {
      const others = { type: "scatter", mode: "lines", hoverinfo: "skip", name: "other cases", x: [], y: [],
        line: { width: 0.6, color: "rgba(128,128,128,0.35)" } };
      const some = left.filter((row, place) => row !== open && place % Math.ceil(left.length / 200) === 0);
      for (const row of some) { others.x.push(0, ...curves.travel[row], null); others.y.push(0, ...curves.force[row], null); }
      const own = { type: "scatter", mode: "lines+markers", name: `case ${columns[0].values[open]}`,
        x: [0, ...curves.travel[open]], y: [0, ...curves.force[open]], line: { color: "#d55e00", width: 2.5 } };
      show(byId("curve"), [others, own], { xaxis: { title: { text: "travel, mm" } }, yaxis: { title: { text: "axial force, N" } } });
    }
  };
  new MutationObserver((_, observer) => {
    if (!byId("over").on) return;
    observer.disconnect();
    byId("over").on("plotly_click", ({ points }) => { if (points[0].customdata !== undefined) unfold(points[0].customdata, true); });
  }).observe(byId("over"), { childList: true, subtree: true });

  heads();
  sieve();
  page.showNamed(figures);
  page.ready();
})();
