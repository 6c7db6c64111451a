// Show the scenes that have the chosen flag and level.
"use strict";

const form = document.querySelector(".filters");
const cards = [...document.querySelectorAll(".card")];
const chosen = (name) => document.getElementById(name).value;

function filter() {
  for (const card of cards) {
    const fits = (name, words) => !chosen(name) || words.split(" ").includes(chosen(name));
    card.hidden = !(fits("flag", card.dataset.flags) && fits("level", card.dataset.levels));
  }
  for (const group of document.querySelectorAll("section")) group.hidden = !group.querySelector(".card:not([hidden])");
  const shown = cards.filter((card) => !card.hidden).length;
  document.getElementById("count").textContent = `${shown} of ${cards.length} scenes`;
}

form.hidden = false;
form.addEventListener("input", filter);
filter();
