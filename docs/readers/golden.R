# Read a golden dataset in R, as doubles from hexfloats: Rscript golden.R data/golden/paris
folder <- commandArgs(trailingOnly = TRUE)[1]
file <- function(name) file.path(folder, name)
words <- function(name) read.csv(file(name), colClasses = "character")  # R rounds decimals by itself not always right
manifest <- paste(readLines(file("manifest.json")), collapse = "\n")
bounds <- sub('.*"bounds": ', "", manifest)
bound <- function(column) {  # the first is the grid's
  found <- regmatches(bounds, regexpr(sprintf('"%s": "[^"]*"', column), bounds))
  sub('.*: "([^"]*)"', "\\1", found)
}

grid <- words("grid.binary64.csv")
last <- grid[nrow(grid), ]
cat("grid", nrow(grid), "\n")
cat("t", sprintf("%.17g", as.numeric(last$t_hex)), "\n")
for (column in c("x", "y", "z", "vx", "vy", "vz")) {
  value <- as.numeric(last[[paste0(column, "_hex")]])
  cat(column, sprintf("%.17g", value), bound(column), "\n")
}
if (file.exists(file("transits.csv"))) {
  transits <- words("transits.csv")
  cat("transits", nrow(transits), format(max(as.numeric(transits$bound))), "\n")
}
