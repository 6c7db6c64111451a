// Read a golden dataset in Go, as doubles from hexfloats, and its vectors: go run golden.go data/golden/paris
package main

import (
	"encoding/csv"
	"encoding/json"
	"fmt"
	"os"
	"strconv"
)

type manifest struct{ Bounds map[string]any }
type vector struct{ Values map[string]map[string]string }
type vectors struct{ States, Transits []vector }

func must[T any](value T, err error) T {
	if err != nil {
		panic(err)
	}
	return value
}
func open(name string) *os.File    { return must(os.Open(os.Args[1] + "/" + name)) }
func float(text string) float64    { return must(strconv.ParseFloat(text, 64)) } // decimals and hexfloats alike
func table(name string) [][]string { return must(csv.NewReader(open(name)).ReadAll()) }
func main() {
	about, tests := manifest{}, vectors{}
	must(0, json.NewDecoder(open("manifest.json")).Decode(&about))
	must(0, json.NewDecoder(open("vectors.json")).Decode(&tests))
	grid, transits, largest := table("grid.binary64.csv"), table("transits.csv"), 0.0
	last, bounds := grid[len(grid)-1], about.Bounds["grid"].(map[string]any)
	fmt.Printf("grid %d\nt %v\n", len(grid)-1, float(last[7])) // the first row is the header
	for i, name := range grid[0][1:7] {
		fmt.Println(name, float(last[8+i]), bounds[name])
	}
	for _, row := range transits[1:] { // k,t,direction,x,y,z,vy,ax,bound
		largest = max(largest, float(row[8]))
	}
	fmt.Println("transits", len(transits)-1, largest)
	fmt.Println("vectors", len(tests.States), len(tests.Transits), tests.States[1].Values["x"]["hexfloat"])
}
