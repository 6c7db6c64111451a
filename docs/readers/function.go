// Evaluate a golden function in Go: go run function.go FOLDER 17.25 3600
// Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation.
package main

import (
	"encoding/binary"
	"encoding/json"
	"fmt"
	"math"
	"os"
	"sort"
	"strconv"
)

func number(text string) float64 {
	value, err := strconv.ParseFloat(text, 64)
	if err != nil {
		panic(err)
	}
	return value
}

func contents(name string) []byte {
	data, err := os.ReadFile(os.Args[1] + "/" + name)
	if err != nil {
		panic(err)
	}
	return data
}

func main() {
	var about struct {
		Degree     int
		Components []string
		Square     *string `json:"length_squared"`
		Times      []string
	}
	if err := json.Unmarshal(contents("function.json"), &about); err != nil {
		panic(err)
	}
	data, last := contents("function.f64"), len(about.Times)-1
	times := make([]float64, last+1)
	for i, text := range about.Times {
		times[i] = number(text)
	}
	for _, text := range os.Args[2:] {
		t := number(text)
		if !(t >= 0 && t <= times[last]) {
			panic(fmt.Sprintf("%v: not within 0 to %v s", t, times[last]))
		}
		piece := sort.Search(last-1, func(i int) bool { return times[i+1] > t }) // the first that ends later, or the last
		a, b := times[piece], times[piece+1]
		w := b - a
		u := ((t - a) - (b - t)) / w
		y, state := u+u, make([]float64, 6)
		for i := range about.Components {
			c := func(k int) float64 {
				at := 8 * ((piece*len(about.Components)+i)*(about.Degree+1) + k)
				return math.Float64frombits(binary.LittleEndian.Uint64(data[at:]))
			}
			var b1, b2, d1, d2 float64
			for k := about.Degree; k > 0; k-- {
				b1, b2 = (y*b1-b2)+c(k), b1
				d1, d2 = (y*d1-d2)+float64(k)*c(k), d1
			}
			state[i], state[i+3] = (u*b1-b2)+c(0), (d1+d1)/w
		}
		if about.Square != nil {
			x, y := state[0], state[1]
			state[2] = -math.Sqrt(number(*about.Square) - (x*x + y*y))
			state[5] = -(x*state[3] + y*state[4]) / state[2]
		}
		fmt.Printf("%.17g", t)
		for _, value := range state {
			fmt.Printf(" %.17g", value)
		}
		fmt.Println()
	}
}
