# Evaluate a golden function in R: Rscript function.R FOLDER 17.25 0x1.c2p+11
# Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation.
words <- commandArgs(trailingOnly = TRUE)
file <- function(name) file.path(words[1], name)
json <- paste(readLines(file("function.json")), collapse = " ")
value <- function(key) {  # the words in what follows "key":, one value or a list of them
  found <- regmatches(json, regexpr(sprintf('"%s": (\\[[^]]*\\]|"[^"]*"|[^,}]*)', key), json))
  scan(text = gsub('[][",]', " ", sub('^"[^"]*": ', "", found)), what = "", quiet = TRUE)
}

times <- as.numeric(value("times"))  # R reads hexfloats exactly
degree <- as.integer(value("degree"))
series <- length(value("components"))
size <- file.size(file("function.f64")) / 8
numbers <- readBin(file("function.f64"), "double", size, endian = "little")
coefficients <- array(numbers, c(degree + 1, series, length(times) - 1))

at <- function(t) {  # columns x, y, z, vx, vy, vz; a row for each time
  if (!all(is.finite(t) & t >= 0 & t <= tail(times, 1))) {
    stop(sprintf("a time is not within 0 to %.17g s", tail(times, 1)))
  }
  piece <- findInterval(t, times, rightmost.closed = TRUE)  # a <= t < b but at the very end
  a <- times[piece]
  b <- times[piece + 1]
  w <- b - a
  u <- ((t - a) - (b - t)) / w
  y <- u + u
  position <- velocity <- matrix(0, length(t), 3)
  for (i in seq_len(series)) {
    b1 <- b2 <- d1 <- d2 <- 0
    for (k in rev(seq_len(degree))) {
      c <- coefficients[k + 1, i, piece]
      b0 <- (y * b1 - b2) + c
      b2 <- b1
      b1 <- b0
      d0 <- (y * d1 - d2) + k * c
      d2 <- d1
      d1 <- d0
    }
    position[, i] <- (u * b1 - b2) + coefficients[1, i, piece]
    velocity[, i] <- (d1 + d1) / w
  }
  if (series == 2) {
    x <- position[, 1]
    y <- position[, 2]
    z <- -sqrt(as.numeric(value("length_squared")) - (x * x + y * y))
    position[, 3] <- z
    velocity[, 3] <- -(x * velocity[, 1] + y * velocity[, 2]) / z
  }
  cbind(position, velocity)
}

t <- as.numeric(words[-1])  # may miss the nearest double of a decimal by one; "0x1.14p+4" is exact
found <- at(t)
cat(paste0(apply(matrix(sprintf("%.17g", cbind(t, found)), length(t)), 1, paste, collapse = " "), "\n"), sep = "")
