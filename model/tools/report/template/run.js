"use strict";
(async () => {
  page.offer(page.byId("case").textContent);
  page.showNamed((await page.begin()).figures);
  page.ready();
})();
