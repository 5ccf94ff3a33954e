"use strict";
// What all pages share: unpacks the library and the data, follows the theme, the width and the choices, draws figures.
const page = (() => {
  const byId = (id) => document.getElementById(id);
  const bytes = (text) => { // a plain loop: Uint8Array.from asks an iterator for each of millions of letters
    const letters = atob(text), found = new Uint8Array(letters.length);
    for (let place = 0; place < letters.length; place++) found[place] = letters.charCodeAt(place);
    return found;
  };
  const inflated = async (id) => {
    const stream = new Blob([bytes(byId(id).textContent)]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  };
  const floats = (text, shape) => {
    const all = new Float32Array(bytes(text).buffer);
    const cut = (from, [size, ...inner]) => {
      if (inner.length === 0) return all.subarray(from, from + size);
      const each = inner.reduce((a, b) => a * b, 1);
      return Array.from({ length: size }, (_, row) => cut(from + row * each, inner));
    };
    return cut(0, shape);
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
  const themed = (layout) => {
    const ink = colour("--ink"), line = colour("--line"), paper = colour("--paper");
    const dressed = structuredClone(layout);
    Object.assign(dressed, {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink, size: 13 }, autosize: true, uirevision: "kept",
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
    if (dressed.scene && innerWidth < 600) { // a narrow window sees the spring from farther away
      for (const key of "xyz") dressed.scene.camera.eye[key] *= 1.8;
    }
    for (const shape of dressed.shapes ?? []) if (shape.fillcolor === "paper") shape.fillcolor = paper;
    for (const note of dressed.annotations ?? []) if (note.showarrow) note.arrowcolor = ink;
    return dressed;
  };

  // A figure is drawn when it comes near the window, and for printing; `figures` has data and layout of each element.
  const options = { responsive: true, displaylogo: false, displayModeBar: false };
  const figures = new Map();
  const draw = (plot) => {
    const { data, layout } = figures.get(plot);
    plot.drawn = true;
    return Plotly.react(plot, data, themed(layout), options);
  };
  const watch = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) if (isIntersecting && !target.drawn) draw(target);
  }, { rootMargin: "100px" });
  const show = (plot, data, layout) => {
    figures.set(plot, { data, layout });
    if (plot.drawn) draw(plot);
    else watch.observe(plot);
  };
  const redress = () => {
    label();
    for (const [plot, { layout }] of figures) if (plot.drawn) Plotly.relayout(plot, themed(layout));
  };

  const PAPER = 640, LOW = 0.7, LOWEST = 0.48; // pixels: the width of a figure on A4 and on Letter; so low that two fit below each other
  let screenTheme, folded, place;
  const onPaper = () => { // light, each figure as wide as the paper, what is folded open
    screenTheme = document.documentElement.dataset.theme;
    document.documentElement.dataset.theme = "light";
    folded = [...document.querySelectorAll("details:not([open])")];
    for (const one of folded) one.open = true;
    const first = byId("first-figure"), own = byId("characteristic"); // the first sheet has the characteristic
    if (first && own) {
      place = document.createComment("characteristic");
      own.replaceWith(place);
      first.append(own);
    }
    for (const [plot, { layout }] of figures) {
      if (!plot.drawn) draw(plot);
      const height = (first?.contains(plot) ? LOWEST : LOW) * Number.parseFloat(plot.style.height);
      Plotly.relayout(plot, { ...themed(layout), autosize: false, width: PAPER, height });
    }
  };
  const onScreen = () => {
    if (screenTheme) document.documentElement.dataset.theme = screenTheme;
    else delete document.documentElement.dataset.theme;
    for (const one of folded) one.open = false;
    if (place) {
      place.replaceWith(byId("characteristic"));
      place = null;
    }
    for (const [plot, { layout }] of figures) Plotly.relayout(plot, { ...themed(layout), width: null, height: null });
  };

  const showNamed = (named) => document.querySelectorAll(".plot[data-figure]").forEach((plot) => {
    const { data, layout, frames } = named[plot.dataset.figure];
    const select = byId(`choice-${plot.dataset.figure}`), slider = byId(`slide-${plot.dataset.figure}`);
    const moments = slider && JSON.parse(slider.dataset.moments);
    const chosen = () => data.map((trace, place) => ({
      ...trace, visible: trace.meta === undefined || trace.meta.choice === (select ? Number(select.value) : 0),
      ...(place === 0 && frames.length ? frames[slider ? Number(slider.value) : 0] : {}),
    }));
    const update = () => {
      show(plot, chosen(), layout);
      if (!slider) return;
      slider.nextElementSibling.textContent = moments[Number(slider.value)];
      slider.setAttribute("aria-valuetext", moments[Number(slider.value)]);
    };
    update();
    select?.addEventListener("change", update);
    slider?.addEventListener("input", update);
  });
  const link = (text) => "data:text/yaml;charset=utf-8," + encodeURIComponent(text);
  const offer = (text) => { byId("save").href = link(text); };
  document.querySelectorAll("a.save").forEach((one) => {
    one.href = link(one.parentElement.nextElementSibling.textContent);
  });

  const begin = async () => {
    label();
    theme.addEventListener("click", () => {
      document.documentElement.dataset.theme = isDark() ? "light" : "dark";
      redress();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redress);
    addEventListener("beforeprint", onPaper);
    addEventListener("afterprint", onScreen);
    try {
      const library = document.createElement("script");
      const [code, data] = await Promise.all([inflated("plotly"), inflated("data")]); // beside each other
      library.textContent = code;
      document.head.append(library);
      return unpacked(JSON.parse(data));
    } catch (error) {
      byId("trouble").textContent = `The figures cannot be drawn by this browser (${error}); a newer one can.`;
      byId("trouble").hidden = false;
      throw error;
    }
  };
  const ready = () => { document.documentElement.dataset.ready = "yes"; };
  return { byId, begin, ready, show, showNamed, offer };
})();
