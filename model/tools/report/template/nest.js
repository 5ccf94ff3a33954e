"use strict";
(async () => {
  page.showNamed((await page.begin()).figures);
  page.ready();
})();
