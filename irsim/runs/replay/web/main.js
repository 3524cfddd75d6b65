// Starts the page: a player of the run that is in the page, or of those that a host tells of.

import { $ } from "./dom.js";
import { connect } from "./host.js";
import { begin, dress, player, say, show } from "./player.js";
import { bytesOf } from "./read.js";

begin();
if ($("data").textContent.trim()) {
  show(bytesOf($("data").textContent)).catch((problem) => say(`This page is damaged: ${problem.message}`));
} else if (window.parent !== window) {
  connect({
    show,
    say: (text) => !player.run && say(text),
    dress(theme) {
      if (theme === "dark" || theme === "light") player.chosenTheme = theme;
      dress();
    },
  });
} else {
  say("There is no run in this page: irsim replay writes one that has it.");
}
