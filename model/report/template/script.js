"use strict";
// Draws the page's figures: unpacks the library and the arrays, follows the theme, the width and the choices.
(async () => {
  const byId = (id) => document.getElementById(id);
  const floats = (text, shape) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const all = new Float32Array(bytes.buffer);
    if (shape.length === 1) return all;
    return Array.from({ length: shape[0] }, (_, row) => all.subarray(row * shape[1], (row + 1) * shape[1]));
  };
  const unpacked = (value) => {
    if (Array.isArray(value)) return value.map(unpacked);
    if (value === null || typeof value !== "object") return value;
    if (value.f4 !== undefined) return floats(value.f4, value.shape);
    return Object.fromEntries(Object.entries(value).map(([key, one]) => [key, unpacked(one)]));
  };
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const isDark = () => {
    const chosen = document.documentElement.dataset.theme;
    return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  };

  const theme = byId("theme");
  const label = () => {
    theme.setAttribute("aria-pressed", String(isDark()));
    theme.textContent = isDark() ? "light" : "dark";
    theme.setAttribute("aria-label", `change to ${isDark() ? "light" : "dark"} colours`);
  };
  label();
  byId("save").href = "data:text/yaml;charset=utf-8," + encodeURIComponent(byId("case").textContent);

  const trouble = (text) => { byId("trouble").textContent = text; byId("trouble").hidden = false; };
  try {
    const packed = Uint8Array.from(atob(byId("plotly").textContent), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const library = document.createElement("script");
    library.textContent = await new Response(stream).text();
    document.head.append(library);
  } catch (error) {
    trouble(`The figures cannot be drawn by this browser (${error}); a newer one can.`);
    return;
  }

  const figures = unpacked(JSON.parse(byId("figures").textContent));
  const themed = (layout) => {
    const ink = colour("--ink"), line = colour("--line"), paper = colour("--paper");
    const dressed = structuredClone(layout);
    Object.assign(dressed, {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink, size: 13 }, autosize: true,
      hoverlabel: { bgcolor: paper, font: { color: ink } },
      legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0, ...layout.legend },
      margin: { l: 62, r: 18, t: 46, b: 52, ...layout.margin },
    });
    for (const key of Object.keys(dressed)) {
      if (/^[xy]axis/.test(key)) Object.assign(dressed[key], { gridcolor: line, zerolinecolor: line, linecolor: line });
    }
    for (const name of ["xaxis", "yaxis", "zaxis"]) {
      if (dressed.scene) Object.assign(dressed.scene[name] ?? {}, { gridcolor: line, color: ink, backgroundcolor: paper });
    }
    for (const shape of dressed.shapes ?? []) if (shape.fillcolor === "paper") shape.fillcolor = paper;
    for (const note of dressed.annotations ?? []) if (note.showarrow) note.arrowcolor = ink;
    return dressed;
  };
  const shown = (traces, choice) => traces.map((trace) => trace.meta === undefined || trace.meta.choice === choice);
  const options = { responsive: true, displaylogo: false, displayModeBar: false };
  const plots = document.querySelectorAll(".plot");
  const chosen = (name) => { const select = byId(`choice-${name}`); return select ? Number(select.value) : 0; };

  const draw = (plot) => {
    const { data, layout } = figures[plot.dataset.figure];
    const visible = shown(data, chosen(plot.dataset.figure));
    plot.drawn = true;
    return Plotly.newPlot(plot, data.map((trace, k) => ({ ...trace, visible: visible[k] })), themed(layout), options);
  };
  const watch = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting && !entry.target.drawn) draw(entry.target);
  }, { rootMargin: "400px" });
  plots.forEach((plot) => watch.observe(plot));
  const redress = () => {
    label();
    plots.forEach((plot) => plot.drawn && Plotly.relayout(plot, themed(figures[plot.dataset.figure].layout)));
  };
  theme.addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    redress();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redress);
  document.querySelectorAll("select[data-figure]").forEach((select) => select.addEventListener("change", () => {
    const plot = document.querySelector(`.plot[data-figure="${select.dataset.figure}"]`);
    if (plot.drawn) Plotly.restyle(plot, { visible: shown(figures[select.dataset.figure].data, Number(select.value)) });
  }));
  addEventListener("beforeprint", () => plots.forEach((plot) => plot.drawn || draw(plot)));
  document.documentElement.dataset.ready = "yes";
})();
